//! `bramah serve`: an HTTP server that shows the circuits and studies of a folder in a browser on this machine.
//!
//! Requests enter from the page (`page/`, compiled into the binary); JSON, HTML and scripts leave. `http` reads
//! requests and writes answers, `guard` refuses foreign sites and paths, `folder` lists the files, `circuits` and
//! `studies` answer the questions.
//!
//! Four worker threads take requests from one listening socket. Anything that takes longer is a job with a thread of
//! its own (`jobs`), and the page polls its state. The server keeps no state except jobs and uploaded recordings.

mod circuits;
mod folder;
mod guard;
mod http;
mod jobs;
mod studies;

use std::net::{Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;

use clap::Args;
use include_dir::{Dir, include_dir};
use tiny_http::Server;

use super::{CommandFailure, CommandStatus, files};
use bramah_model::compile::STACK;
use bramah_syntax::diag::{Code, Diagnostic};
use folder::ServerFolder;
use http::{HttpRefusal, HttpRequest, HttpResponse};
use jobs::ServerJobs;
use studies::UploadStore;

/// The preferred port. Another free one is used when it is taken and the user asked for none.
const PORT: u16 = 8737;
/// Number of worker threads, and so of requests that are answered at the same time. Long work runs in jobs.
const THREADS: usize = 4;

/// Open circuits and studies in a browser: networks, sliders, plots, diagnosis
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  bramah serve press/                  the circuits, studies and recordings of a folder
  bramah serve press/ --open           and show them in the browser
  bramah serve --port 9000

The page is for this machine only: the server listens at 127.0.0.1, answers no other site, opens and writes only what
lies in the folder (a circuit may name a table elsewhere), and needs no network. Ctrl-C ends it.")]
pub(super) struct ServeArgs {
    /// The folder with circuits (.mo), studies (.toml) and recordings (.csv)
    #[arg(value_name = "FOLDER", default_value = ".")]
    folder: PathBuf,
    /// The port [default: 8737, or another where that is taken]
    #[arg(long, value_name = "PORT")]
    port: Option<u16>,
    /// Show the page in the browser
    #[arg(long)]
    open: bool,
}

/// The files of the page, embedded at compile time.
static PAGE: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/src/cli/serve/page");

/// What all worker threads share. Its parts have their own locks.
struct ServerState {
    /// The served folder.
    folder: ServerFolder,
    /// The port that the server listens on; `guard` compares the `Host` header with it.
    port: u16,
    /// Running and finished jobs.
    jobs: ServerJobs,
    /// Uploaded recordings that are not in the folder.
    uploads: UploadStore,
}

/// Listens, prints the address and serves until the process is ended.
///
/// `Err`: the folder cannot be opened, the port is taken, or no thread can be started.
pub(super) fn run(args: &ServeArgs) -> Result<CommandStatus, CommandFailure> {
    let folder = ServerFolder::new(&args.folder)?;
    let server = listen(args.port)?;
    // The port may be chosen by the system (0), so it is read back from the socket.
    let port = server.server_addr().to_ip().map_or(0, |a| a.port());
    let address = format!("http://127.0.0.1:{port}/");
    // The address is printed before the browser opens, as the socket accepts connections already.
    files::print(&format!("{address}  (the page of {}; Ctrl-C ends it)\n", folder.root().display()))?;
    if args.open {
        open(&address);
    }
    let shared = Arc::new(ServerState { folder, port, jobs: ServerJobs::default(), uploads: UploadStore::default() });
    let server = Arc::new(server);
    // Fewer threads than wanted still serve; none do not.
    let workers: Vec<_> = (0..THREADS).filter_map(|_| worker(&server, &shared)).collect();
    if workers.is_empty() {
        return Err(CommandFailure::new(Code::FileAccess, "no thread can be started"));
    }
    // The threads end only when `recv` fails, so this normally waits for Ctrl-C.
    workers.into_iter().for_each(|w| drop(w.join()));
    Ok(CommandStatus::Fine)
}

/// Starts one worker thread. `None` when the system starts no thread.
fn worker(server: &Arc<Server>, shared: &Arc<ServerState>) -> Option<std::thread::JoinHandle<()>> {
    let (server, shared) = (server.clone(), shared.clone());
    let serve = move || {
        while let Ok(request) = server.recv() {
            http::answer(request, |ask| answer(&shared, ask), shared.port);
        }
    };
    // Listing circuits and opening one compiles models on this thread, which recurses deeply.
    std::thread::Builder::new().stack_size(STACK).spawn(serve).ok()
}

/// Binds a socket on 127.0.0.1. Without a wish, the preferred port is tried first, then any free one.
fn listen(port: Option<u16>) -> Result<Server, CommandFailure> {
    // Only the loopback address: machines on the network cannot connect.
    let at = |port| Server::http(SocketAddr::from((Ipv4Addr::LOCALHOST, port)));
    let tried = match port {
        Some(port) => at(port),
        None => at(PORT).or_else(|_| at(0)),
    };
    tried.map_err(|why| {
        let port = port.unwrap_or(PORT);
        let d = Diagnostic::new(Code::FileAccess, format!("the port {port} cannot be used: {why}"));
        d.help("leave out `--port`, and a free one is taken").into()
    })
}

/// Opens an address in the browser. A failure is ignored, since the address is also printed.
fn open(address: &str) {
    let program = if cfg!(target_os = "macos") { "open" } else { "xdg-open" };
    // Output of the browser must not mix with that of the server.
    let _ = Command::new(program).arg(address).stdout(Stdio::null()).stderr(Stdio::null()).spawn();
}

/// Finds the function for a method and path. The first flag is true for POST.
///
/// Everything that writes or starts work is a POST, which `guard` accepts only from the page itself.
fn answer(shared: &Arc<ServerState>, ask: &HttpRequest) -> Result<HttpResponse, HttpRefusal> {
    let ServerState { folder, jobs, uploads, .. } = &**shared;
    match (ask.post, ask.path.as_str()) {
        (false, "/api/folder") => Ok(HttpResponse::json(&folder.contents())),
        (false, "/api/circuit") => circuits::open(folder, ask),
        (true, "/api/run") => circuits::run(folder, ask, jobs),
        (false, "/api/job") => jobs.seen(ask),
        (false, "/api/job/page") => jobs.page(ask),
        (true, "/api/job/stop") => jobs.stop(ask),
        (false, "/api/study") => studies::text(folder, ask),
        (true, "/api/study/read") => studies::read(folder, ask),
        (true, "/api/study/compare") => studies::compare(folder, ask, uploads, jobs),
        (true, "/api/study/diagnose") => studies::diagnose(folder, ask, uploads, jobs),
        (true, "/api/study/save") => studies::save(folder, ask, uploads),
        (true, "/api/recordings") => uploads.take(ask),
        (false, "/api/recording") => uploads.columns(folder, ask),
        (false, path) => page(path).ok_or_else(|| nothing(path)),
        (true, path) => Err(nothing(path)),
    }
}

/// The 404 answer for an unknown path.
fn nothing(path: &str) -> HttpRefusal {
    HttpRefusal::new(404, format!("there is nothing at `{path}`"))
}

/// A file of the page with its content type. `None`: there is no such file, or its type is not served.
fn page(path: &str) -> Option<HttpResponse> {
    let name = if path == "/" { "index.html" } else { path.strip_prefix('/')? };
    // Looked up among the embedded files, so a path cannot reach the disk.
    let text = PAGE.get_file(name)?.contents_utf8()?;
    match Path::new(name).extension()?.to_str()? {
        "html" => Some(HttpResponse::page(text)),
        "css" => Some(HttpResponse::style(text)),
        "js" => Some(HttpResponse::script(text)),
        _ => None,
    }
}
