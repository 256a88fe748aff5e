//! HTTP requests and answers in the form that the rest of the server uses.
//!
//! [`answer`] turns a `tiny_http` request into an [`HttpRequest`], lets `guard` check it, calls the handler and sends
//! the [`HttpResponse`] or [`HttpRefusal`] with security headers. The worker threads of `serve` call it.

use std::collections::BTreeMap;
use std::io::Read;
use std::panic::{AssertUnwindSafe, catch_unwind};

use serde::Serialize;
use serde::de::DeserializeOwned;
use tiny_http::{Header, Method, Request, Response};

use super::guard;
use bramah_syntax::diag::render::full;
use bramah_syntax::diag::{Diagnostic, Sources};

/// Content security policy of the page: it loads only its own files, inline styles, data images and job pages in
/// frames.
const POLICY: &str = "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; \
                      frame-src 'self' blob:; frame-ancestors 'self'; form-action 'none'; base-uri 'none'";
/// Content security policy of the page that a job made: inline scripts and styles only, no network, in a sandbox.
///
/// Names and texts of models reach this page, so it gets no access to the server.
const ALONE: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; \
                     frame-ancestors 'self'; sandbox allow-scripts allow-downloads";

/// A request that has passed the guard, with its complete body.
pub(super) struct HttpRequest {
    /// The method is POST. The only other method is GET.
    pub post: bool,
    /// The path without the query.
    pub path: String,
    /// Decoded values of the query by name.
    query: BTreeMap<String, String>,
    /// The body, at most `guard::LARGEST` bytes.
    body: Vec<u8>,
}

impl HttpRequest {
    /// A value of the query; empty when it is missing.
    pub fn value(&self, name: &str) -> &str {
        self.query.get(name).map_or("", String::as_str)
    }

    /// Parses the body as JSON. `Err` is a refusal with status 400.
    pub fn json<T: DeserializeOwned>(&self) -> Result<T, HttpRefusal> {
        let read = serde_json::from_slice(&self.body);
        read.map_err(|why| HttpRefusal::new(400, format!("the request cannot be read: {why}")))
    }

    /// The body as text. Bytes that are not UTF-8 are replaced.
    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }
}

/// An answer of the server.
pub(super) struct HttpResponse {
    /// HTTP status.
    status: u16,
    /// Content type.
    kind: &'static str,
    /// Content security policy.
    policy: &'static str,
    /// Content.
    body: String,
}

impl HttpResponse {
    /// An answer with status 200.
    fn new(kind: &'static str, policy: &'static str, body: impl Into<String>) -> Self {
        HttpResponse { status: 200, kind, policy, body: body.into() }
    }

    /// The HTML page of the server itself.
    pub fn page(text: &str) -> Self {
        HttpResponse::new("text/html; charset=utf-8", POLICY, text)
    }

    /// A complete HTML page made by a job, which carries its own script and runs in a sandbox.
    pub fn report(text: String) -> Self {
        HttpResponse::new("text/html; charset=utf-8", ALONE, text)
    }

    /// A style sheet of the page.
    pub fn style(text: &str) -> Self {
        HttpResponse::new("text/css; charset=utf-8", POLICY, text)
    }

    /// A script of the page.
    pub fn script(text: &str) -> Self {
        HttpResponse::new("text/javascript; charset=utf-8", POLICY, text)
    }

    /// A value as JSON.
    pub fn json(value: &impl Serialize) -> Self {
        let text = serde_json::to_string(value).expect("texts and numbers always serialize");
        HttpResponse::new("application/json", POLICY, text)
    }

    /// The same answer with another status.
    pub fn with_status(mut self, status: u16) -> Self {
        self.status = status;
        self
    }
}

/// An error answer. It is sent as JSON with a field `messages`.
#[derive(Debug)]
pub(super) struct HttpRefusal {
    /// HTTP status.
    pub status: u16,
    /// Text for the user, formatted as messages on a terminal.
    pub messages: String,
}

impl HttpRefusal {
    /// A refusal with one sentence.
    pub fn new(status: u16, message: impl Into<String>) -> Self {
        HttpRefusal { status, messages: message.into() }
    }

    /// A refusal (422) with diagnostics of the user's texts.
    pub fn of(diagnostics: &[Diagnostic], sources: &Sources) -> Self {
        HttpRefusal { status: 422, messages: full(sources, diagnostics) }
    }
}

impl From<super::CommandFailure> for HttpRefusal {
    /// A failure of a function shared with the command line becomes a refusal with status 422.
    fn from(failure: super::CommandFailure) -> Self {
        HttpRefusal::of(&failure.diagnostics, &Sources::default())
    }
}

/// The JSON body of a refusal.
#[derive(Serialize)]
struct RefusalBody<'a> {
    /// Text for the user.
    messages: &'a str,
}

/// Reads a request, calls `act` and sends the answer.
///
/// `guard` runs first. A panic in `act` becomes a 500 answer, so that the worker thread survives.
pub(super) fn answer(
    mut request: Request,
    act: impl FnOnce(&HttpRequest) -> Result<HttpResponse, HttpRefusal>,
    port: u16,
) {
    // The guard sees the headers before the body is read, so a foreign site cannot make the server read an upload.
    let answered = guard::allowed(&request, port).and_then(|()| read(&mut request)).and_then(|ask| {
        // The panic hook has printed the details on the terminal.
        let bug = |_| HttpRefusal::new(500, "this is a bug of bramah; its terminal says more");
        catch_unwind(AssertUnwindSafe(|| act(&ask))).unwrap_or_else(|panic| Err(bug(panic)))
    });
    let answer = answered
        .unwrap_or_else(|why| HttpResponse::json(&RefusalBody { messages: &why.messages }).with_status(why.status));
    let headers = [
        ("Content-Type", answer.kind),
        ("Content-Security-Policy", answer.policy),
        // Results change at any time; a cached answer would show old ones.
        ("Cache-Control", "no-store"),
        // A browser must not run an uploaded text as a script because of what it looks like.
        ("X-Content-Type-Options", "nosniff"),
        ("Referrer-Policy", "no-referrer"),
        ("Cross-Origin-Resource-Policy", "same-origin"),
    ];
    let plain = Response::from_string(answer.body).with_status_code(answer.status);
    // The length is known, so the body is sent in one piece instead of chunks.
    let mut response = plain.with_chunked_threshold(usize::MAX);
    for (name, value) in headers {
        response.add_header(Header::from_bytes(name, value).expect("the names and values above are plain"));
    }
    // The browser may have closed the connection; there is nobody to report it to.
    let _ = request.respond(response);
}

/// Reads method, path, query and body. `Err`: another method (405), a broken body (400) or a too large one (413).
fn read(request: &mut Request) -> Result<HttpRequest, HttpRefusal> {
    let post = match request.method() {
        Method::Get => false,
        Method::Post => true,
        other => return Err(HttpRefusal::new(405, format!("{other} is not answered"))),
    };
    let (path, query) = request.url().split_once('?').unwrap_or((request.url(), ""));
    let query = form_urlencoded::parse(query.as_bytes()).into_owned().collect();
    let path = path.to_owned();
    let mut body = Vec::new();
    // One byte more than allowed, to detect a body that is too large without reading all of it. The length in the
    // header may be missing or wrong.
    let limited = &mut request.as_reader().take(guard::LARGEST + 1);
    limited.read_to_end(&mut body).map_err(|why| HttpRefusal::new(400, format!("the request broke off: {why}")))?;
    if body.len() as u64 > guard::LARGEST {
        return Err(guard::too_large());
    }
    Ok(HttpRequest { post, path, query, body })
}
