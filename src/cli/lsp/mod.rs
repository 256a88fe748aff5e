//! `bramah lsp`: the language server, which speaks the Language Server Protocol over stdin and stdout.
//!
//! Requests and notifications of an editor enter; answers and diagnostics leave. `answers` answers requests, `files`
//! holds the open texts, `checker` compiles in the background. The logic about Modelica is in the crate
//! `bramah_editor`.
//!
//! Two threads: the main one answers requests from the open texts, so that typing stays fast. The other compiles the
//! models of a file after each change and gives up when a newer text arrives.

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

/// Serves one editor until it disconnects or asks to exit. `Err`: the connection broke, or a library folder is missing.
pub(super) fn run(args: &LspArgs) -> Result<CommandStatus, CommandFailure> {
    let (connection, threads) = Connection::stdio();
    let served = serve(&connection, folders(&args.library)?);
    // The threads of the connection end only when its channels are closed, so this must precede `join`.
    drop(connection);
    let joined = threads.join();
    let broken =
        |why: String| CommandFailure::new(Code::FileAccess, format!("the connection to the editor broke: {why}"));
    let ending = served.map_err(&broken)?;
    joined.map_err(|e| broken(e.to_string()))?;
    Ok(ending)
}

/// The state of the server on its main thread.
struct LanguageServer<'c> {
    /// Channels to and from the editor.
    connection: &'c Connection,
    /// The open texts, and the answers from them.
    answers: LspWorkspace,
    /// The thread that compiles.
    checker: BackgroundChecker,
    /// Diagnostics by the file that was checked. They may concern other files too.
    said: std::collections::BTreeMap<PathBuf, Vec<messages::FileDiagnostic>>,
}

/// Performs the handshake and serves.
///
/// Returns `Wrong` (exit code 1) when the editor sends `exit` without `shutdown`, as the protocol demands. `Err`: the
/// handshake or the connection failed.
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
    /// The main loop: takes messages of the editor and results of the checker, whichever comes first.
    fn listen(&mut self) -> Result<CommandStatus, String> {
        // A clone of the receiver, since `self` is borrowed mutably in the branches.
        let results = self.checker.results.clone();
        loop {
            select! {
                recv(self.connection.receiver) -> message => match message {
                    Ok(Message::Request(request)) => {
                        // Answers `shutdown` and waits for the `exit` after it.
                        if self.connection.handle_shutdown(&request).map_err(|e| e.to_string())? {
                            return Ok(CommandStatus::Fine);
                        }
                        let response = self.answer(request);
                        self.connection.sender.send(response.into()).map_err(|e| e.to_string())?;
                    }
                    Ok(Message::Notification(n)) if n.method == notification::Exit::METHOD => return Ok(CommandStatus::Wrong),
                    Ok(Message::Notification(notification)) => self.notice(&notification),
                    // The server sends no requests, so a response has no meaning.
                    Ok(Message::Response(_)) => {}
                    // The editor has closed the connection without `exit`.
                    Err(_) => return Ok(CommandStatus::Fine),
                },
                recv(results) -> checked => if let Ok(checked) = checked {
                    self.learn(checked);
                },
            }
        }
    }

    /// Answers one request. Errors and panics become error responses, so that they do not end the server.
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

    /// Handles a notification: texts opened, changed, closed or saved. Others are ignored.
    ///
    /// A notification with parameters that do not fit is ignored, since it cannot be answered.
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
                // Each change refers to the text after the changes before it, so their order matters.
                p.content_changes.iter().for_each(|change| apply(&mut text, change));
                self.changed(path, &text);
            }
            notification::DidCloseTextDocument::METHOD => {
                let Some(p) = read::<lsp_types::DidCloseTextDocumentParams>(notification) else { return };
                if let Some(path) = self.answers.cache.path(&p.text_document.uri) {
                    self.answers.open.close(&path);
                    // Diagnostics of a closed file are withdrawn.
                    self.say(&path, Vec::new());
                }
            }
            notification::DidSaveTextDocument::METHOD => {
                // Other open files may use classes of the saved one.
                let all: Vec<PathBuf> = self.answers.open.paths().cloned().collect();
                all.iter().for_each(|path| self.check(path));
            }
            _ => {}
        }
    }

    /// Stores a new text of a file and checks it.
    fn changed(&mut self, path: PathBuf, text: &str) {
        self.answers.open.set(path.clone(), text);
        self.check(&path);
    }

    /// Publishes syntax errors at once; without any, asks the checker to compile the file.
    ///
    /// A text with syntax errors is not compiled: errors of later stages would only follow from them.
    fn check(&mut self, path: &Path) {
        // The user cannot change files that ship, so they are not checked.
        if bramah_editor::is_shipped(path) {
            return;
        }
        let found = messages::of_syntax(path, self.answers.open.get(path).unwrap_or_default());
        if found.is_empty() {
            self.checker.ask(path.to_path_buf(), self.answers.open.clone());
        } else {
            // A pending result belongs to an older text and would overwrite the syntax errors.
            self.checker.forget(path);
            self.say(path, found);
        }
    }

    /// Takes a result of the checker.
    ///
    /// Diagnostics of an outdated text are dropped; a newer check is on its way.
    fn learn(&mut self, checked: CheckResult) {
        // Values of parameters are useful even when the text has changed since.
        self.answers.facts = checked.facts;
        // Places of messages are valid only for the text that was compiled.
        let current = checked.open.get(&checked.path) == self.answers.open.get(&checked.path);
        if current {
            self.say(&checked.path, checked.messages);
        }
    }

    /// Stores the diagnostics of a checked file, and publishes those of every file that has or had some.
    ///
    /// The protocol replaces all diagnostics of a file at once. So for each concerned file those of all checks are
    /// collected.
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
            // Two files that use the same broken class report the same error.
            for message in self.said.values().flatten().filter(|m| m.path == path) {
                if !diagnostics.contains(&message.diagnostic) {
                    diagnostics.push(message.diagnostic.clone());
                }
            }
            let params = lsp_types::PublishDiagnosticsParams { uri, diagnostics, version: None };
            let method = notification::PublishDiagnostics::METHOD.to_owned();
            // A closed connection is noticed by the main loop.
            let _ = self.connection.sender.send(Notification::new(method, params).into());
        }
    }
}

/// The parameters of a notification; `None` when they do not fit, and the notification is ignored.
fn read<P: DeserializeOwned>(notification: &Notification) -> Option<P> {
    serde_json::from_value(notification.params.clone()).ok()
}

/// Applies one change to a text: the complete new text, or the replacement of a range.
fn apply(text: &mut String, change: &lsp_types::TextDocumentContentChangeEvent) {
    match change.range {
        None => text.clone_from(&change.text),
        Some(range) => {
            let start = lines::offset(text, range.start) as usize;
            // A range that ends before its start would panic below.
            let end = (lines::offset(text, range.end) as usize).max(start);
            text.replace_range(start..end, &change.text);
        }
    }
}

/// The open texts with the library folders, as the editor crate takes them.
fn texts<'t>(open: &'t OpenTexts, libraries: &'t [PathBuf]) -> bramah_editor::EditorWorkspace<'t> {
    bramah_editor::EditorWorkspace { world: open, libraries }
}
