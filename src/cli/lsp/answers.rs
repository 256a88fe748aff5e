//! Answers the requests of an editor: completion, hover, navigation, renaming, formatting, quick fixes, pictures.
//!
//! A request enters, a JSON value or an error text leaves. [`LspWorkspace`] builds a view of the file from the open
//! texts and calls a function of `bramah_editor`, which knows the language. Here are only the protocol types.

use std::collections::{BTreeMap, HashMap};
use std::path::PathBuf;

use lsp_server::Request;
use lsp_types::request::{self, Request as _};
use lsp_types::{
    CodeAction, CodeActionOrCommand, CodeActionParams, CompletionList, CompletionResponse, DocumentSymbolResponse,
    FoldingRangeParams, GotoDefinitionParams, GotoDefinitionResponse, InlayHintParams, Location, Position, Range,
    ReferenceParams, RenameFile, ResourceOp, SemanticTokens, TextDocumentEdit, TextDocumentPositionParams, TextEdit,
    Uri, WorkspaceEdit,
};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::super::files::modelica_below;
use super::files::{OpenTexts, ShippedFileCache};
use super::texts;
use bramah_editor::hints::{ParameterHints, hints};
use bramah_editor::messages::FileDiagnostic;
use bramah_editor::navigate::{self, DeclarationSite, FileRange};
use bramah_editor::{DocumentView, complete, hover, is_shipped, lines, outline, signature, tokens};
use bramah_model::compile::{Request as Wanted, graph, runnable};
use bramah_plot::network;
use bramah_syntax::diag::FileId;
use bramah_syntax::format::format;

/// Method of the request for the picture of a model's network. It is an extension of the protocol.
const NETWORK: &str = "bramah/network";

/// The open texts with all that answers need.
pub(super) struct LspWorkspace {
    /// Open texts over the disk.
    pub open: OpenTexts,
    /// Folders of libraries, from the command line and the editor's settings.
    pub libraries: Vec<PathBuf>,
    /// Maps files that ship to files on disk.
    pub cache: ShippedFileCache,
    /// Values of parameters from the last checks, for hints and hover.
    pub facts: ParameterHints,
    /// Folders that the editor has opened. References and renaming search them.
    roots: Vec<PathBuf>,
}

/// The capabilities that the server announces in the handshake.
pub(super) fn capabilities() -> Value {
    serde_json::json!({
        // 2: the editor sends changed ranges instead of entire texts.
        "textDocumentSync": { "openClose": true, "change": 2, "save": true },
        "completionProvider": { "triggerCharacters": [".", "(", "\""] },
        "signatureHelpProvider": { "triggerCharacters": ["(", ","] },
        "hoverProvider": true,
        "definitionProvider": true,
        "typeDefinitionProvider": true,
        "referencesProvider": true,
        "documentHighlightProvider": true,
        "renameProvider": { "prepareProvider": true },
        "documentSymbolProvider": true,
        "foldingRangeProvider": true,
        "documentFormattingProvider": true,
        "codeActionProvider": { "codeActionKinds": ["quickfix"] },
        "inlayHintProvider": true,
        "semanticTokensProvider": {
            "legend": { "tokenTypes": tokens::TYPES, "tokenModifiers": tokens::MODIFIERS },
            "full": true,
        },
        // Not part of the protocol. Extensions look for it before they offer the picture.
        "experimental": { "networkProvider": true },
    })
}

/// The result of a request as JSON, or the text of an error.
type LspAnswer = Result<Value, String>;

/// Parameters of the request for a network's picture.
// Read from JSON, so the names are those of the request.
#[derive(Deserialize)]
struct NetworkParams {
    /// URI of the file.
    uri: Uri,
    /// The class to draw; `None` for the first of the file that can run.
    model: Option<String>,
}

impl LspWorkspace {
    /// A workspace from the parameters of the handshake and the libraries of the command line.
    pub fn new(params: &Value, mut libraries: Vec<PathBuf>) -> LspWorkspace {
        let cache = ShippedFileCache::new();
        let address = |v: &Value| serde_json::from_value::<Uri>(v.clone()).ok().and_then(|uri| cache.path(&uri));
        let folders = params["workspaceFolders"].as_array().into_iter().flatten();
        let mut roots: Vec<PathBuf> = folders.filter_map(|f| address(&f["uri"])).collect();
        // Older editors send a single root instead of a list of folders.
        if roots.is_empty() {
            roots.extend(address(&params["rootUri"]));
        }
        let options = params["initializationOptions"]["libraries"].as_array().into_iter().flatten();
        libraries.extend(options.filter_map(|l| l.as_str()).map(PathBuf::from));
        LspWorkspace { open: OpenTexts::default(), libraries, cache, facts: ParameterHints::default(), roots }
    }

    /// Answers a request. `None` for a method that is not offered.
    ///
    /// `said` has the published diagnostics, from which quick fixes are made.
    pub fn answer(&mut self, request: &Request, said: &BTreeMap<PathBuf, Vec<FileDiagnostic>>) -> Option<LspAnswer> {
        let params = &request.params;
        Some(match request.method.as_str() {
            request::Completion::METHOD => self.at_place(params, |_, view, at| {
                let items = complete::complete(view, at);
                Some(CompletionResponse::List(CompletionList { is_incomplete: false, items }))
            }),
            request::SignatureHelpRequest::METHOD => self.at_place(params, |_, view, at| signature::help(view, at)),
            request::HoverRequest::METHOD => {
                self.at_place(params, |answers, view, at| hover::hover(view, at, &answers.facts))
            }
            request::GotoDefinition::METHOD => self.go(params, navigate::definition),
            request::GotoTypeDefinition::METHOD => self.go(params, navigate::type_definition),
            request::References::METHOD => self.references(params),
            request::DocumentHighlightRequest::METHOD => self.highlights(params),
            request::PrepareRenameRequest::METHOD => self.at_place(params, |_, view, at| {
                // Refused here already, so that the editor does not ask for a new name in vain.
                let declared = navigate::declared(view, at).filter(|d| !is_shipped(&d.place.path))?;
                let found = navigate::occurrence_at(view, at)?;
                Some(serde_json::json!({ "range": view.range(found.ident.span), "placeholder": declared.name }))
            }),
            request::Rename::METHOD => self.rename(params),
            request::DocumentSymbolRequest::METHOD => {
                self.of_file(params, |_, view| DocumentSymbolResponse::Nested(outline::symbols(view)))
            }
            request::FoldingRangeRequest::METHOD => read::<FoldingRangeParams>(params).and_then(|p| {
                // Folding needs only the tokens of the text, so it works for a text with syntax errors.
                let text = self.text(&p.text_document.uri)?;
                write(outline::folds(&text))
            }),
            request::Formatting::METHOD => self.formatting(params),
            request::CodeActionRequest::METHOD => self.actions(params, said),
            request::InlayHintRequest::METHOD => read::<InlayHintParams>(params).and_then(|p| {
                let facts = &self.facts;
                let all = self.look(&p.text_document.uri, |view| hints(view, facts));
                let shown = |h: &lsp_types::InlayHint| p.range.start <= h.position && h.position <= p.range.end;
                write(all.unwrap_or_default().into_iter().filter(shown).collect::<Vec<_>>())
            }),
            request::SemanticTokensFullRequest::METHOD => {
                self.of_file(params, |_, view| SemanticTokens { result_id: None, data: tokens::tokens(view) })
            }
            NETWORK => self.network(params),
            _ => return None,
        })
    }

    /// Calls `act` with a view of a file. `None`: the URI is no file, or the file cannot be read.
    ///
    /// The file and the classes it needs are read and parsed anew for each call.
    fn look<T>(&self, uri: &Uri, act: impl FnOnce(&mut DocumentView<'_, '_>) -> T) -> Option<T> {
        let path = self.cache.path(uri)?;
        texts(&self.open, &self.libraries).look(&path, |mut view| act(&mut view))
    }

    /// Answers about a position; null when `act` finds nothing there.
    ///
    /// `params` has the file and the position. `Err`: they do not fit the protocol.
    fn at_place<T: serde::Serialize>(
        &self,
        params: &Value,
        act: impl FnOnce(&Self, &mut DocumentView<'_, '_>, u32) -> Option<T>,
    ) -> LspAnswer {
        let p: TextDocumentPositionParams = read(params)?;
        let found = self.look(&p.text_document.uri, |view| {
            let at = lines::offset(&view.text, p.position);
            act(self, view, at)
        });
        write(found.flatten())
    }

    /// Answers about an entire file; null when it cannot be read.
    fn of_file<T: serde::Serialize>(
        &self,
        params: &Value,
        act: impl FnOnce(&Self, &mut DocumentView<'_, '_>) -> T,
    ) -> LspAnswer {
        let uri: Uri = read(&params["textDocument"]["uri"])?;
        write(self.look(&uri, |view| act(self, view)))
    }

    /// The current text of a file, open or on disk.
    fn text(&self, uri: &Uri) -> Result<String, String> {
        let path = self.cache.path(uri).ok_or("the address is not that of a file")?;
        let text = texts(&self.open, &self.libraries).read(&path);
        text.ok_or_else(|| format!("`{}` cannot be read", path.display()))
    }

    /// Answers with the place that `find` returns, or null.
    fn go(&self, params: &Value, find: impl FnOnce(&mut DocumentView<'_, '_>, u32) -> Option<FileRange>) -> LspAnswer {
        let p: GotoDefinitionParams = read(params)?;
        let p = p.text_document_position_params;
        let place = self.look(&p.text_document.uri, |view| {
            let at = lines::offset(&view.text, p.position);
            find(view, at)
        });
        write(place.flatten().and_then(|place| self.location(&place)).map(GotoDefinitionResponse::Scalar))
    }

    /// A place as a location of the protocol. `None`: the file has no URI.
    fn location(&self, place: &FileRange) -> Option<Location> {
        Some(Location { uri: self.cache.uri(&place.path)?, range: place.lsp_range() })
    }

    /// The declaration of the name at a position, and its uses in the user's files.
    fn used(&self, uri: &Uri, position: Position) -> Option<(DeclarationSite, Vec<FileRange>)> {
        let declared = self.look(uri, |view| {
            let at = lines::offset(&view.text, position);
            navigate::declared(view, at)
        })??;
        // A local name cannot be used elsewhere, so the other files need not be read.
        let files = if declared.local { self.cache.path(uri).into_iter().collect() } else { self.own_files(uri) };
        let places = navigate::references(&texts(&self.open, &self.libraries), &files, &declared);
        Some((declared, places))
    }

    /// The user's files: those of the editor's folders, those that are open, and that of the request.
    ///
    /// Files that ship with bramah are left out. The list is sorted and has each file once.
    fn own_files(&self, uri: &Uri) -> Vec<PathBuf> {
        // Copies of the text in build output and Node packages must not be renamed with the original.
        let skipped = |name: &str| name == "target" || name == "node_modules";
        let mut files: Vec<PathBuf> = self.roots.iter().flat_map(|root| modelica_below(root, &skipped)).collect();
        files.extend(self.open.paths().filter(|p| !is_shipped(p)).cloned());
        files.extend(self.cache.path(uri).filter(|p| !is_shipped(p)));
        // A file may be found in several ways but must be edited once.
        files.sort();
        files.dedup();
        files
    }

    /// Answers with all uses of a name, with its declaration when the editor asks for it.
    fn references(&self, params: &Value) -> LspAnswer {
        let p: ReferenceParams = read(params)?;
        let at = &p.text_document_position;
        let Some((declared, mut places)) = self.used(&at.text_document.uri, at.position) else {
            return Ok(Value::Null);
        };
        if !p.context.include_declaration {
            places.retain(|place| *place != declared.place);
        } else if !places.contains(&declared.place) {
            places.insert(0, declared.place);
        }
        write(places.iter().filter_map(|place| self.location(place)).collect::<Vec<_>>())
    }

    /// Answers with the uses of a name in the same file.
    fn highlights(&self, params: &Value) -> LspAnswer {
        let p: TextDocumentPositionParams = read(params)?;
        let path = self.cache.path(&p.text_document.uri).ok_or("the address is not that of a file")?;
        let declared = self.look(&p.text_document.uri, |view| {
            let at = lines::offset(&view.text, p.position);
            navigate::declared(view, at)
        });
        let Some(declared) = declared.flatten() else { return Ok(Value::Null) };
        let places = navigate::references(&texts(&self.open, &self.libraries), std::slice::from_ref(&path), &declared);
        let here = places.iter().filter(|place| place.path == path);
        write(
            here.map(|place| lsp_types::DocumentHighlight { range: place.lsp_range(), kind: None }).collect::<Vec<_>>(),
        )
    }

    /// Answers with the edits that rename a declaration. `Err` says why it cannot be renamed.
    ///
    /// The declaration must be in a file of the user, and the new name a free identifier.
    fn rename(&self, params: &Value) -> LspAnswer {
        let p: lsp_types::RenameParams = read(params)?;
        if !navigate::is_name(&p.new_name) {
            return Err(format!("`{}` is not a name: letters, digits and `_`, no keyword", p.new_name));
        }
        let at = &p.text_document_position;
        let found = self.used(&at.text_document.uri, at.position);
        let (declared, places) = found.ok_or("there is nothing here that can be renamed")?;
        if is_shipped(&declared.place.path) {
            return Err(format!("`{}` ships with bramah", declared.name));
        }
        // References in files outside the editor's folders would not be changed.
        if !self.own_files(&at.text_document.uri).contains(&declared.place.path) {
            return Err(format!("`{}` is declared in a library", declared.name));
        }
        // A duplicate name would change the meaning of the text.
        if let Some(taken) = self.taken(&at.text_document.uri, at.position, &p.new_name) {
            return Err(taken);
        }
        // Grouped by file and sorted, so that equal requests give equal answers.
        let mut edits: BTreeMap<PathBuf, Vec<TextEdit>> = BTreeMap::new();
        for place in places {
            let edit = TextEdit { range: place.lsp_range(), new_text: p.new_name.clone() };
            edits.entry(place.path).or_default().push(edit);
        }
        write(self.workspace_edit(edits, declared.own_file.then_some((&declared.place.path, &p.new_name))))
    }

    /// The reason why a name cannot be given to the declaration at a position: its class has such a name already.
    fn taken(&self, uri: &Uri, position: Position, name: &str) -> Option<String> {
        let class = self.look(uri, |view| {
            let at = lines::offset(&view.text, position);
            navigate::class_with(view, at, name)
        })??;
        Some(format!("there is a `{name}` in `{class}` already"))
    }

    /// Builds the answer to a renaming. `file` is the path and the new name when the class has a file of its own, which
    /// is then renamed too.
    ///
    /// A `package.mo` stands for its folder, which gets the new name.
    fn workspace_edit(
        &self,
        edits: BTreeMap<PathBuf, Vec<TextEdit>>,
        file: Option<(&PathBuf, &String)>,
    ) -> WorkspaceEdit {
        // Without a file to rename the simple form suffices, which needs no support of file operations in the editor.
        let Some((path, name)) = file else {
            let changes = edits.into_iter().filter_map(|(path, edits)| Some((self.cache.uri(&path)?, edits)));
            return edit_of(changes);
        };
        let mut all: Vec<lsp_types::DocumentChangeOperation> = Vec::new();
        // Edits come before the renaming, as they refer to the old path.
        for (path, edits) in edits {
            let Some(uri) = self.cache.uri(&path) else { continue };
            let document = lsp_types::OptionalVersionedTextDocumentIdentifier { uri, version: None };
            let edits = edits.into_iter().map(lsp_types::OneOf::Left).collect();
            all.push(lsp_types::DocumentChangeOperation::Edit(TextDocumentEdit { text_document: document, edits }));
        }
        let (old, new) = match path.file_name() {
            // A package is stored as a folder, so the folder changes its name.
            Some(f) if f == "package.mo" => {
                let folder = path.parent().unwrap_or(path);
                (folder.to_path_buf(), folder.with_file_name(name))
            }
            _ => (path.clone(), path.with_file_name(format!("{name}.mo"))),
        };
        if let (Some(old_uri), Some(new_uri)) = (self.cache.uri(&old), self.cache.uri(&new)) {
            let rename = RenameFile { old_uri, new_uri, options: None, annotation_id: None };
            all.push(lsp_types::DocumentChangeOperation::Op(ResourceOp::Rename(rename)));
        }
        let changes = lsp_types::DocumentChanges::Operations(all);
        WorkspaceEdit { document_changes: Some(changes), ..WorkspaceEdit::default() }
    }

    /// Answers with the formatted text, or null when the text has syntax errors.
    fn formatting(&self, params: &Value) -> LspAnswer {
        let uri: Uri = read(&params["textDocument"]["uri"])?;
        let text = self.text(&uri)?;
        let Ok(new_text) = format(FileId(0), &text) else { return Ok(Value::Null) };
        // No edit keeps the editor from marking the file as changed.
        if new_text == text {
            return write(Vec::<TextEdit>::new());
        }
        // One edit replaces the entire text.
        let range = Range::new(Position::new(0, 0), lines::position(&text, text.len() as u32));
        write(vec![TextEdit { range, new_text }])
    }

    /// Answers with the quick fixes of diagnostics that touch the range.
    ///
    /// They come from the published diagnostics, so nothing is compiled for the answer.
    fn actions(&self, params: &Value, said: &BTreeMap<PathBuf, Vec<FileDiagnostic>>) -> LspAnswer {
        let p: CodeActionParams = read(params)?;
        let path = self.cache.path(&p.text_document.uri).ok_or("the address is not that of a file")?;
        let mut actions = Vec::new();
        for message in said.values().flatten().filter(|m| m.path == path) {
            let range = message.diagnostic.range;
            let touched = range.start <= p.range.end && p.range.start <= range.end;
            let Some(correction) = message.correction.as_ref().filter(|_| touched) else { continue };
            let change = (p.text_document.uri.clone(), vec![correction.edit.clone()]);
            actions.push(CodeActionOrCommand::CodeAction(CodeAction {
                title: correction.title.clone(),
                kind: Some(lsp_types::CodeActionKind::QUICKFIX),
                diagnostics: Some(vec![message.diagnostic.clone()]),
                edit: Some(edit_of(std::iter::once(change))),
                is_preferred: Some(true),
                ..CodeAction::default()
            }));
        }
        write(actions)
    }

    /// Answers with the network of a model as SVG, even when ports are still open.
    ///
    /// The compiler reads the open texts, also those that are not saved.
    ///
    /// `Err`: the file has no model that can be drawn.
    fn network(&self, params: &Value) -> LspAnswer {
        let p: NetworkParams = read(params)?;
        let path = self.cache.path(&p.uri).ok_or("the address is not that of a file")?;
        let shipped =
            // A file that ships is not on the disk by its path. Its class is compiled by name instead.
            is_shipped(&path).then(|| self.look(&p.uri, |view| Some(view.library.full_name(*view.classes.first()?))));
        let source = shipped.flatten().flatten().map_or_else(|| path.clone(), PathBuf::from);
        let request = Wanted { source, libraries: self.libraries.clone(), ..Wanted::default() };
        let model = match p.model {
            Some(model) => Some(model),
            None if is_shipped(&path) => None,
            None => runnable(&self.open, &request).ok().and_then(|all| all.into_iter().next()).map(|r| r.class),
        };
        let outcome = graph(&self.open, &Wanted { model, ..request });
        let first = outcome.diagnostics.iter().find(|d| d.is_error()).map(|d| d.message.clone());
        let (model, graph) = outcome.value.ok_or(first.unwrap_or_else(|| "there is no model here".to_owned()))?;
        Ok(serde_json::json!({ "model": model, "svg": network::write(&graph, &model) }))
    }
}

/// An edit of the protocol from changes by file.
#[allow(clippy::mutable_key_type, reason = "the protocol keeps edits in a map by address; nothing changes its keys")]
fn edit_of(changes: impl Iterator<Item = (Uri, Vec<TextEdit>)>) -> WorkspaceEdit {
    let changes: HashMap<Uri, Vec<TextEdit>> = changes.collect();
    WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() }
}

/// Reads the parameters of a request. `Err` is the text for the editor.
fn read<P: DeserializeOwned>(params: &Value) -> Result<P, String> {
    serde_json::from_value(params.clone()).map_err(|e| e.to_string())
}

/// Writes an answer as JSON.
fn write(answer: impl serde::Serialize) -> LspAnswer {
    serde_json::to_value(answer).map_err(|e| e.to_string())
}
