//! The server of `bramah serve` as a browser meets it, and as it meets those who should not use it.
#![allow(clippy::disallowed_methods, reason = "starts the command, and waits for its jobs")]

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

const MODEL: &str = "model Tank \"a tank\"
  input Real u(unit = \"m/s\");
  parameter Real k(unit = \"1/s\", min = 0, max = 10) = 1 \"outflow\";
  parameter Integer n = 1;
  Real h(unit = \"m\", displayUnit = \"mm\", start = 0, fixed = true);
equation
  der(h) = u - k*n*h;
  annotation(experiment(StopTime = 2));
end Tank;
";

const STUDY: &str = "version = 1
model = \"Tank.mo\"
class = \"Tank\"
[inputs]
u = { column = \"u\", unit = \"m/s\" }
[signals]
h = { variable = \"h\", column = \"h\", unit = \"mm\" }
[[recordings]]
file = \"train.csv\"
";

/// A server with its folder.
struct Server {
    process: Child,
    port: u16,
    folder: tempfile::TempDir,
}

impl Drop for Server {
    fn drop(&mut self) {
        drop(self.process.kill());
        drop(self.process.wait());
    }
}

impl Server {
    fn start() -> Server {
        let folder = tempfile::tempdir().expect("a folder");
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("written");
        write("Tank.mo", MODEL);
        write("Broken.mo", "model Broken Nothing x; end Broken;");
        let mut process = Command::new(env!("CARGO_BIN_EXE_bramah"))
            .args(["serve", "."])
            .current_dir(&folder)
            .env_remove("MODELICAPATH")
            .stdout(Stdio::piped())
            .spawn()
            .expect("the server starts");
        let mut line = String::new();
        let out = process.stdout.take().expect("piped");
        BufReader::new(out).read_line(&mut line).expect("its first line");
        let port = line.strip_prefix("http://127.0.0.1:").and_then(|l| l.split('/').next()?.parse().ok());
        Server { process, port: port.unwrap_or_else(|| panic!("no address in `{line}`")), folder }
    }

    /// Status, header and body of an answer.
    fn raw(&self, request: &str, body: &[u8]) -> (u16, String, String) {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).expect("it listens");
        stream.write_all(request.as_bytes()).expect("sent");
        // a server that has refused may have hung up
        drop(stream.write_all(body));
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).expect("an answer");
        let answer = String::from_utf8(answer).expect("text");
        let (head, body) = answer.split_once("\r\n\r\n").expect("a head");
        let status = head.split(' ').nth(1).and_then(|s| s.parse().ok()).expect("a status");
        (status, head.to_owned(), body.to_owned())
    }

    fn get(&self, path: &str) -> (u16, Value) {
        let request = format!("GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nConnection: close\r\n\r\n", self.port);
        let (status, _, body) = self.raw(&request, b"");
        (status, serde_json::from_str(&body).unwrap_or(Value::Null))
    }

    fn post(&self, path: &str, body: &str) -> (u16, Value) {
        let request = format!(
            "POST {path} HTTP/1.1\r\nHost: localhost:{p}\r\nOrigin: http://localhost:{p}\r\nContent-Length: {}\r\n\
             Connection: close\r\n\r\n",
            body.len(),
            p = self.port
        );
        let (status, _, body) = self.raw(&request, body.as_bytes());
        (status, serde_json::from_str(&body).unwrap_or(Value::Null))
    }

    /// Begins a job and waits for its end.
    fn job(&self, path: &str, body: &Value) -> Value {
        let (status, begun) = self.post(path, &body.to_string());
        assert_eq!(status, 200, "{begun}");
        for _ in 0..3000 {
            let (_, seen) = self.get(&format!("/api/job?id={}", begun["job"]));
            if seen["state"] != "running" {
                return seen;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        panic!("{path} does not end");
    }

    fn folder(&self) -> &Path {
        self.folder.path()
    }
}

fn text<'a>(value: &'a Value, key: &str) -> &'a str {
    value[key].as_str().unwrap_or_else(|| panic!("no `{key}` in {value}"))
}

#[test]
fn a_circuit_is_opened_and_run() {
    let server = Server::start();
    let (_, folder) = server.get("/api/folder");
    let listed = folder["circuits"].as_array().expect("circuits");
    assert!(listed.iter().any(|c| c["class"] == "Tank" && c["description"] == "a tank"), "{folder}");
    let shipped = folder["shipped"].as_array().expect("shipped");
    assert!(shipped.iter().any(|c| c["class"] == "ServoPump.DeadZone"), "{folder}");
    let (status, circuit) = server.get("/api/circuit?source=Tank.mo&class=Tank");
    assert_eq!(status, 200);
    assert_eq!(circuit["parameters"][0]["max"], "10");
    assert_eq!(circuit["parameters"][1]["structural"], false);
    assert_eq!(circuit["inputs"][0]["unit"], "m/s");
    let set = |set: Value| json!({ "source": "Tank.mo", "class": "Tank", "set": set, "units": "engineering" });
    let refused = server.job("/api/run", &set(json!({})));
    assert!(text(&refused, "messages").contains("E106"), "{refused}");
    let run = server.job("/api/run", &set(json!({ "u": "1 m/s", "k": "2 1/s" })));
    assert_eq!(run["state"], "done", "{run}");
    assert!(text(&run, "page").contains("h in mm"));
    let unknown = server
        .job("/api/run", &json!({ "source": "Tank.mo", "class": "Tank", "variables": ["hh"], "set": { "u": "1" } }));
    assert!(text(&unknown, "messages").contains("`hh` matches no variable"), "{unknown}");
    let outside = server.job("/api/run", &set(json!({ "u": "1", "k": "11" })));
    assert!(text(&outside, "messages").contains("E215"), "{outside}");
    let (status, broken) = server.get("/api/circuit?source=Broken.mo&class=Broken");
    assert_eq!(status, 422);
    assert!(text(&broken, "messages").contains("there is no class `Nothing`"), "{broken}");
}

#[test]
fn a_study_is_compared_and_saved() {
    let server = Server::start();
    let mut rows = String::from("time,u,h [mm]\n");
    for k in 0..200 {
        let time = 0.02 * f64::from(k);
        let u = if k / 50 % 2 == 0 { 1.0 } else { 0.0 };
        rows += &format!("{time},{u},{}\n", 300.0 + f64::from(k % 7));
    }
    let (status, taken) = server.post("/api/recordings?name=train.csv", &rows);
    assert_eq!((status, &taken["rows"]), (200, &json!(200)), "{taken}");
    assert_eq!(taken["columns"][1], json!({ "name": "h", "unit": "mm" }));
    let (_, form) = server.post("/api/study/read", &json!({ "text": STUDY, "folder": "" }).to_string());
    assert_eq!(form["signals"][0]["variable"], "h");
    let compared = server.job("/api/study/compare", &json!({ "text": STUDY, "folder": "" }));
    assert_eq!(compared["state"], "done", "{compared}");
    assert!(text(&compared, "page").contains("simulated"));
    let save = |text: &str, replace: bool| {
        server.post("/api/study/save", &json!({ "file": "rig.toml", "text": text, "replace": replace }).to_string())
    };
    assert_eq!(save(STUDY, false), (200, json!({ "written": ["rig.toml", "train.csv"] })));
    assert_eq!(std::fs::read_to_string(server.folder().join("train.csv")).expect("written"), rows);
    let other = format!("# another\n{STUDY}");
    assert_eq!(save(&other, false).0, 409);
    assert_eq!(save(&other, true).0, 200);
    let (_, read) = server.get("/api/study?file=rig.toml");
    assert_eq!(text(&read, "text"), other);
}

#[test]
fn what_is_wrong_is_said() {
    let server = Server::start();
    let wrong = |path: &str, body: &str, status: u16, part: &str| {
        let (found, said) = server.post(path, body);
        assert_eq!(found, status, "{path} {said}");
        assert!(text(&said, "messages").contains(part), "{path} {said}");
    };
    wrong("/api/recordings?name=a.csv", "1,2\n3,4\n", 422, "E601");
    wrong("/api/recordings?name=..%2Fa.csv", "t,x\n0,1\n", 422, "is no name of a recording");
    wrong("/api/run", "{", 400, "cannot be read");
    wrong("/api/run", r#"{ "source": "Tank.mo", "class": "Tank", "stop": "soon" }"#, 422, "`soon` is not a number");
    wrong("/api/study/read", r#"{ "text": "version = 1\n[inptus]" }"#, 422, "did you mean `inputs`");
    wrong("/api/study/save", r#"{ "file": "../x.toml", "text": "version = 1" }"#, 403, "not in the folder");
    wrong("/api/study/save", r#"{ "file": "Tank.mo", "text": "version = 1" }"#, 422, "ends in `.toml`");
    wrong("/api/job/stop", r#"{ "id": 99 }"#, 404, "no job 99");
    let climbing = STUDY.replace("train.csv", "../../secret.csv");
    wrong("/api/study/compare", &json!({ "text": climbing }).to_string(), 403, "not in the folder");
    assert_eq!(server.get("/api/circuit?source=..%2F..%2Fx.mo&class=x").0, 403);
    assert_eq!(server.get("/api/recording?name=%2Fetc%2Fpasswd").0, 403);
    assert_eq!(server.get("/../Cargo.toml").0, 404);
}

#[test]
fn others_are_refused() {
    let server = Server::start();
    let port = server.port;
    let asked = |head: &str| server.raw(&format!("{head}Connection: close\r\n\r\n"), b"").0;
    assert_eq!(asked(&format!("GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n")), 200);
    assert_eq!(asked(&format!("GET / HTTP/1.1\r\nHost: evil.example:{port}\r\n")), 403);
    assert_eq!(asked("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n"), 403);
    let post =
        |more: &str| asked(&format!("POST /api/run HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nContent-Length: 0\r\n{more}"));
    assert_eq!(post("Origin: http://evil.example\r\n"), 403);
    assert_eq!(post("Origin: null\r\n"), 403);
    assert_eq!(post("Sec-Fetch-Site: cross-site\r\n"), 403);
    assert_eq!(post(&format!("Origin: http://127.0.0.1:{port}\r\n")), 400);
    let large =
        format!("POST /api/recordings?name=a.csv HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nContent-Length: 300000000\r\n");
    assert_eq!(asked(&large), 413);
    assert_eq!(asked(&format!("DELETE / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n")), 405);
    let (_, head, _) =
        server.raw(&format!("GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: close\r\n\r\n"), b"");
    assert!(head.contains("Content-Security-Policy: default-src 'self'"), "{head}");
}
