//! Requests and answers as the rest of the server sees them.

use std::collections::BTreeMap;
use std::io::Read;
use std::panic::{AssertUnwindSafe, catch_unwind};

use serde::Serialize;
use serde::de::DeserializeOwned;
use tiny_http::{Header, Method, Request, Response};

use super::guard;
use bramah_syntax::diag::render::full;
use bramah_syntax::diag::{Diagnostic, Sources};

/// What the page itself may load.
const POLICY: &str = "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; \
                      frame-src 'self' blob:; frame-ancestors 'self'; form-action 'none'; base-uri 'none'";
/// What the page of a job may load: its own script and nothing else.
const ALONE: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; \
                     frame-ancestors 'self'; sandbox allow-scripts allow-downloads";

/// A request.
pub(super) struct HttpRequest {
    /// It may change something.
    pub post: bool,
    /// Without query.
    pub path: String,
    query: BTreeMap<String, String>,
    body: Vec<u8>,
}

impl HttpRequest {
    /// A value of the query.
    pub fn value(&self, name: &str) -> &str {
        self.query.get(name).map_or("", String::as_str)
    }

    /// The body as JSON.
    pub fn json<T: DeserializeOwned>(&self) -> Result<T, HttpRefusal> {
        let read = serde_json::from_slice(&self.body);
        read.map_err(|why| HttpRefusal::new(400, format!("the request cannot be read: {why}")))
    }

    /// The body as text; letters of old encodings do no harm.
    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }
}

/// An answer.
pub(super) struct HttpResponse {
    status: u16,
    kind: &'static str,
    policy: &'static str,
    body: String,
}

impl HttpResponse {
    fn new(kind: &'static str, policy: &'static str, body: impl Into<String>) -> Self {
        HttpResponse { status: 200, kind, policy, body: body.into() }
    }

    /// The page.
    pub fn page(text: &str) -> Self {
        HttpResponse::new("text/html; charset=utf-8", POLICY, text)
    }

    /// A page made by a job, with a script of its own.
    pub fn report(text: String) -> Self {
        HttpResponse::new("text/html; charset=utf-8", ALONE, text)
    }

    /// A style sheet.
    pub fn style(text: &str) -> Self {
        HttpResponse::new("text/css; charset=utf-8", POLICY, text)
    }

    /// A script.
    pub fn script(text: &str) -> Self {
        HttpResponse::new("text/javascript; charset=utf-8", POLICY, text)
    }

    /// Data.
    pub fn json(value: &impl Serialize) -> Self {
        let text = serde_json::to_string(value).expect("texts and numbers always serialize");
        HttpResponse::new("application/json", POLICY, text)
    }

    /// The same with another status than 200.
    pub fn with_status(mut self, status: u16) -> Self {
        self.status = status;
        self
    }
}

/// An answer that says why not.
#[derive(Debug)]
pub(super) struct HttpRefusal {
    /// Of HTTP.
    pub status: u16,
    /// As on a terminal.
    pub messages: String,
}

impl HttpRefusal {
    /// One sentence.
    pub fn new(status: u16, message: impl Into<String>) -> Self {
        HttpRefusal { status, messages: message.into() }
    }

    /// What is wrong with the texts of the user.
    pub fn of(diagnostics: &[Diagnostic], sources: &Sources) -> Self {
        HttpRefusal { status: 422, messages: full(sources, diagnostics) }
    }
}

impl From<super::CommandFailure> for HttpRefusal {
    fn from(failure: super::CommandFailure) -> Self {
        HttpRefusal::of(&failure.diagnostics, &Sources::default())
    }
}

#[derive(Serialize)]
struct RefusalBody<'a> {
    messages: &'a str,
}

/// Answers a request that the guard lets in. A panic is an answer too, and the server goes on.
pub(super) fn answer(
    mut request: Request,
    act: impl FnOnce(&HttpRequest) -> Result<HttpResponse, HttpRefusal>,
    port: u16,
) {
    let answered = guard::allowed(&request, port).and_then(|()| read(&mut request)).and_then(|ask| {
        let bug = |_| HttpRefusal::new(500, "this is a bug of bramah; its terminal says more");
        catch_unwind(AssertUnwindSafe(|| act(&ask))).unwrap_or_else(|panic| Err(bug(panic)))
    });
    let answer = answered
        .unwrap_or_else(|why| HttpResponse::json(&RefusalBody { messages: &why.messages }).with_status(why.status));
    let headers = [
        ("Content-Type", answer.kind),
        ("Content-Security-Policy", answer.policy),
        ("Cache-Control", "no-store"),
        ("X-Content-Type-Options", "nosniff"),
        ("Referrer-Policy", "no-referrer"),
        ("Cross-Origin-Resource-Policy", "same-origin"),
    ];
    let plain = Response::from_string(answer.body).with_status_code(answer.status);
    let mut response = plain.with_chunked_threshold(usize::MAX);
    for (name, value) in headers {
        response.add_header(Header::from_bytes(name, value).expect("the names and values above are plain"));
    }
    // A page that has gone away does not matter.
    let _ = request.respond(response);
}

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
    let limited = &mut request.as_reader().take(guard::LARGEST + 1);
    limited.read_to_end(&mut body).map_err(|why| HttpRefusal::new(400, format!("the request broke off: {why}")))?;
    if body.len() as u64 > guard::LARGEST {
        return Err(guard::too_large());
    }
    Ok(HttpRequest { post, path, query, body })
}
