//! `bramah serve`: circuits and studies of a folder in a browser.
//!
//! `guard` decides who may ask for what, `jobs` holds what takes time, `circuits` and `studies` answer. The page
//! (`page/`) talks to them in JSON; nothing is kept in the server but uploaded recordings.

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

/// The port where it is free and none is asked for.
const PORT: u16 = 8737;
/// Requests that are answered at the same time; what takes long is a job with a thread of its own.
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

/// The files of the page.
static PAGE: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/src/cli/serve/page");

/// What all requests share.
struct ServerState {
    folder: ServerFolder,
    port: u16,
    jobs: ServerJobs,
    uploads: UploadStore,
}

pub(super) fn run(args: &ServeArgs) -> Result<CommandStatus, CommandFailure> {
    let folder = ServerFolder::new(&args.folder)?;
    let server = listen(args.port)?;
    let port = server.server_addr().to_ip().map_or(0, |a| a.port());
    let address = format!("http://127.0.0.1:{port}/");
    files::print(&format!("{address}  (the page of {}; Ctrl-C ends it)\n", folder.root().display()))?;
    if args.open {
        open(&address);
    }
    let shared = Arc::new(ServerState { folder, port, jobs: ServerJobs::default(), uploads: UploadStore::default() });
    let server = Arc::new(server);
    let workers: Vec<_> = (0..THREADS).filter_map(|_| worker(&server, &shared)).collect();
    if workers.is_empty() {
        return Err(CommandFailure::new(Code::FileAccess, "no thread can be started"));
    }
    workers.into_iter().for_each(|w| drop(w.join()));
    Ok(CommandStatus::Fine)
}

fn worker(server: &Arc<Server>, shared: &Arc<ServerState>) -> Option<std::thread::JoinHandle<()>> {
    let (server, shared) = (server.clone(), shared.clone());
    let serve = move || {
        while let Ok(request) = server.recv() {
            http::answer(request, |ask| answer(&shared, ask), shared.port);
        }
    };
    std::thread::Builder::new().stack_size(STACK).spawn(serve).ok()
}

fn listen(port: Option<u16>) -> Result<Server, CommandFailure> {
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

/// Shows an address in the browser; where there is none, the user has the address.
fn open(address: &str) {
    let program = if cfg!(target_os = "macos") { "open" } else { "xdg-open" };
    let _ = Command::new(program).arg(address).stdout(Stdio::null()).stderr(Stdio::null()).spawn();
}

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

fn nothing(path: &str) -> HttpRefusal {
    HttpRefusal::new(404, format!("there is nothing at `{path}`"))
}

/// A file of the page.
fn page(path: &str) -> Option<HttpResponse> {
    let name = if path == "/" { "index.html" } else { path.strip_prefix('/')? };
    let text = PAGE.get_file(name)?.contents_utf8()?;
    match Path::new(name).extension()?.to_str()? {
        "html" => Some(HttpResponse::page(text)),
        "css" => Some(HttpResponse::style(text)),
        "js" => Some(HttpResponse::script(text)),
        _ => None,
    }
}
