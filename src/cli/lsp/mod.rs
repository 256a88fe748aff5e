//! `bramah lsp`: the language server, over stdin and stdout.
//!
//! One thread answers requests from the texts at hand; another compiles the models of a file after each change, and gives up
//! a file for a newer one.

mod answers;
mod checker;
mod files;

use std::path::{Path, PathBuf};

use clap::Args;
use crossbeam_channel::select;
use lsp_server::{Connection, ErrorCode, Message, Notification, Request, Response};
use lsp_types::notification::{self, Notification as _};
use serde::de::DeserializeOwned;

use super::request::folders;
use super::{CommandFailure, CommandStatus};
use answers::LspWorkspace;
use bramah_editor::{lines, messages};
use bramah_syntax::diag::Code;
use checker::{BackgroundChecker, CheckResult};
use files::OpenTexts;

/// Serve an editor: messages, completions, definitions, renaming and more, by the language server protocol
#[derive(Args, Debug)]
#[command(after_help = "\
Editors start it themselves; `editors/` has an extension for VS Code and settings for Neovim and Helix.

Examples:
  bramah lsp                            what an editor runs
  bramah lsp --library ~/ModelicaStandardLibrary_v4.1.0")]
pub(super) struct LspArgs {
    /// A folder with further packages; may be repeated. MODELICAPATH is searched after them
    #[arg(short = 'L', long, value_name = "DIR")]
    library: Vec<String>,
    /// The only transport there is; accepted because editors name it
    #[arg(long, hide = true)]
    stdio: bool,
}

pub(super) fn run(args: &LspArgs) -> Result<CommandStatus, CommandFailure> {
    let (connection, threads) = Connection::stdio();
    let served = serve(&connection, folders(&args.library)?);
    drop(connection);
    let joined = threads.join();
    let broken =
        |why: String| CommandFailure::new(Code::FileAccess, format!("the connection to the editor broke: {why}"));
    let ending = served.map_err(&broken)?;
    joined.map_err(|e| broken(e.to_string()))?;
    Ok(ending)
}

/// What the server knows.
struct LanguageServer<'c> {
    connection: &'c Connection,
    answers: LspWorkspace,
    checker: BackgroundChecker,
    /// What was said of each file that was checked.
    said: std::collections::BTreeMap<PathBuf, Vec<messages::FileDiagnostic>>,
}

/// The protocol wants 1 from a server that is ended without having been shut down.
fn serve(connection: &Connection, libraries: Vec<PathBuf>) -> Result<CommandStatus, String> {
    let (id, params) = connection.initialize_start().map_err(|e| e.to_string())?;
    let answers = LspWorkspace::new(&params, libraries);
    let ready = serde_json::json!({
        "capabilities": answers::capabilities(),
        "serverInfo": { "name": "bramah", "version": env!("CARGO_PKG_VERSION") },
    });
    connection.initialize_finish(id, ready).map_err(|e| e.to_string())?;
    let checker = BackgroundChecker::start(answers.libraries.clone(), answers.cache.clone());
    let mut server = LanguageServer { connection, answers, checker, said: std::collections::BTreeMap::new() };
    server.listen()
}

impl LanguageServer<'_> {
    fn listen(&mut self) -> Result<CommandStatus, String> {
        let results = self.checker.results.clone();
        loop {
            select! {
                recv(self.connection.receiver) -> message => match message {
                    Ok(Message::Request(request)) => {
                        if self.connection.handle_shutdown(&request).map_err(|e| e.to_string())? {
                            return Ok(CommandStatus::Fine);
                        }
                        let response = self.answer(request);
                        self.connection.sender.send(response.into()).map_err(|e| e.to_string())?;
                    }
                    Ok(Message::Notification(n)) if n.method == notification::Exit::METHOD => return Ok(CommandStatus::Wrong),
                    Ok(Message::Notification(notification)) => self.notice(&notification),
                    Ok(Message::Response(_)) => {}
                    // the editor has gone
                    Err(_) => return Ok(CommandStatus::Fine),
                },
                recv(results) -> checked => if let Ok(checked) = checked {
                    self.learn(checked);
                },
            }
        }
    }

    /// A request that fails must not end the server.
    fn answer(&mut self, request: Request) -> Response {
        let id = request.id.clone();
        let said = &self.said;
        let answers = &mut self.answers;
        let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| answers.answer(&request, said)));
        match outcome {
            Ok(Some(Ok(value))) => Response::new_ok(id, value),
            Ok(Some(Err(why))) => Response::new_err(id, ErrorCode::RequestFailed as i32, why),
            Ok(None) => {
                Response::new_err(id, ErrorCode::MethodNotFound as i32, format!("`{}` is not offered", request.method))
            }
            Err(_) => Response::new_err(id, ErrorCode::InternalError as i32, "this is a bug of bramah".to_owned()),
        }
    }

    fn notice(&mut self, notification: &Notification) {
        match notification.method.as_str() {
            notification::DidOpenTextDocument::METHOD => {
                let Some(p) = read::<lsp_types::DidOpenTextDocumentParams>(notification) else { return };
                if let Some(path) = self.answers.cache.path(&p.text_document.uri) {
                    self.changed(path, &p.text_document.text);
                }
            }
            notification::DidChangeTextDocument::METHOD => {
                let Some(p) = read::<lsp_types::DidChangeTextDocumentParams>(notification) else { return };
                let Some(path) = self.answers.cache.path(&p.text_document.uri) else { return };
                let mut text = self.answers.open.get(&path).unwrap_or_default().to_owned();
                p.content_changes.iter().for_each(|change| apply(&mut text, change));
                self.changed(path, &text);
            }
            notification::DidCloseTextDocument::METHOD => {
                let Some(p) = read::<lsp_types::DidCloseTextDocumentParams>(notification) else { return };
                if let Some(path) = self.answers.cache.path(&p.text_document.uri) {
                    self.answers.open.close(&path);
                    self.say(&path, Vec::new());
                }
            }
            notification::DidSaveTextDocument::METHOD => {
                // others may use what has changed
                let all: Vec<PathBuf> = self.answers.open.paths().cloned().collect();
                all.iter().for_each(|path| self.check(path));
            }
            _ => {}
        }
    }

    fn changed(&mut self, path: PathBuf, text: &str) {
        self.answers.open.set(path.clone(), text);
        self.check(&path);
    }

    /// What the parser says at once, the rest when it is there.
    fn check(&mut self, path: &Path) {
        if bramah_editor::is_shipped(path) {
            return;
        }
        let found = messages::of_syntax(path, self.answers.open.get(path).unwrap_or_default());
        if found.is_empty() {
            self.checker.ask(path.to_path_buf(), self.answers.open.clone());
        } else {
            self.checker.forget(path);
            self.say(path, found);
        }
    }

    fn learn(&mut self, checked: CheckResult) {
        self.answers.facts = checked.facts;
        let current = checked.open.get(&checked.path) == self.answers.open.get(&checked.path);
        if current {
            self.say(&checked.path, checked.messages);
        }
    }

    /// Publishes what is said of a file now, in every file that is or was concerned.
    fn say(&mut self, of: &Path, found: Vec<messages::FileDiagnostic>) {
        let before = self.said.insert(of.to_path_buf(), found).unwrap_or_default();
        let now = self.said.get(of).into_iter().flatten();
        let mut concerned: Vec<PathBuf> = before.iter().chain(now).map(|m| m.path.clone()).collect();
        concerned.push(of.to_path_buf());
        concerned.sort();
        concerned.dedup();
        for path in concerned {
            let Some(uri) = self.answers.cache.uri(&path) else { continue };
            let mut diagnostics: Vec<lsp_types::Diagnostic> = Vec::new();
            for message in self.said.values().flatten().filter(|m| m.path == path) {
                if !diagnostics.contains(&message.diagnostic) {
                    diagnostics.push(message.diagnostic.clone());
                }
            }
            let params = lsp_types::PublishDiagnosticsParams { uri, diagnostics, version: None };
            let method = notification::PublishDiagnostics::METHOD.to_owned();
            // an editor that has gone away is noticed at the next message from it
            let _ = self.connection.sender.send(Notification::new(method, params).into());
        }
    }
}

fn read<P: DeserializeOwned>(notification: &Notification) -> Option<P> {
    serde_json::from_value(notification.params.clone()).ok()
}

fn apply(text: &mut String, change: &lsp_types::TextDocumentContentChangeEvent) {
    match change.range {
        None => text.clone_from(&change.text),
        Some(range) => {
            let start = lines::offset(text, range.start) as usize;
            let end = (lines::offset(text, range.end) as usize).max(start);
            text.replace_range(start..end, &change.text);
        }
    }
}

/// The texts and what surrounds them, for one look.
fn texts<'t>(open: &'t OpenTexts, libraries: &'t [PathBuf]) -> bramah_editor::EditorWorkspace<'t> {
    bramah_editor::EditorWorkspace { world: open, libraries }
}
