//! The language server as an editor starts it: the command itself, over its stdin and stdout.
#![allow(clippy::disallowed_methods, reason = "starts the command")]

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// An editor with one server.
struct Editor {
    server: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
    /// Diagnostics as they were published last, by address.
    said: std::collections::BTreeMap<String, Vec<Value>>,
    next: u64,
}

impl Editor {
    fn start(folder: &Path) -> Editor {
        let mut server = Command::new(env!("CARGO_BIN_EXE_bramah"))
            .args(["lsp", "--stdio"])
            .env("XDG_CACHE_HOME", folder.join("cache"))
            .env_remove("MODELICAPATH")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the server starts");
        let (to, from) = (server.stdin.take().expect("piped"), BufReader::new(server.stdout.take().expect("piped")));
        let mut editor = Editor { server, to, from, said: Default::default(), next: 0 };
        let root = uri(folder);
        let ready = editor.ask("initialize", json!({ "capabilities": {}, "rootUri": root }));
        assert_eq!(ready["serverInfo"]["name"], "bramah");
        editor.tell("initialized", json!({}));
        editor
    }

    fn send(&mut self, message: &Value) {
        let text = message.to_string();
        write!(self.to, "Content-Length: {}\r\n\r\n{text}", text.len()).expect("the server reads");
        self.to.flush().expect("the server reads");
    }

    fn tell(&mut self, method: &str, params: Value) {
        self.send(&json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    fn receive(&mut self) -> Value {
        let mut length = 0;
        loop {
            let mut line = String::new();
            assert!(self.from.read_line(&mut line).expect("readable") > 0, "the server is there");
            match line.trim().strip_prefix("Content-Length: ") {
                Some(number) => length = number.parse().expect("a length"),
                None if line.trim().is_empty() => break,
                None => {}
            }
        }
        let mut bytes = vec![0; length];
        self.from.read_exact(&mut bytes).expect("the whole message");
        let message: Value = serde_json::from_slice(&bytes).expect("JSON");
        if message["method"] == "textDocument/publishDiagnostics" {
            let address = message["params"]["uri"].as_str().expect("an address").to_owned();
            self.said.insert(address, message["params"]["diagnostics"].as_array().expect("a list").clone());
        }
        message
    }

    fn ask_raw(&mut self, method: &str, params: Value) -> Value {
        self.next += 1;
        let id = self.next;
        self.send(&json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }));
        loop {
            let message = self.receive();
            if message["id"] == id {
                return message;
            }
        }
    }

    fn ask(&mut self, method: &str, params: Value) -> Value {
        let answer = self.ask_raw(method, params);
        assert!(answer["error"].is_null(), "{method}: {}", answer["error"]);
        answer["result"].clone()
    }

    fn open(&mut self, path: &Path, text: &str) {
        let document = json!({ "uri": uri(path), "languageId": "modelica", "version": 1, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": document }));
    }

    /// Waits until the messages of a file are as wanted.
    fn wait(&mut self, path: &Path, wanted: impl Fn(&[Value]) -> bool) -> Vec<Value> {
        let address = uri(path);
        while !self.said.get(&address).is_some_and(|d| wanted(d)) {
            self.receive();
        }
        self.said[&address].clone()
    }

    fn end(mut self) {
        self.ask("shutdown", Value::Null);
        self.tell("exit", Value::Null);
        assert!(self.server.wait().expect("it ends").success());
    }
}

fn uri(path: &Path) -> String {
    format!("file://{}", path.display()).replace(' ', "%20")
}

fn at(path: &Path, line: u32, character: u32) -> Value {
    json!({ "textDocument": { "uri": uri(path) }, "position": { "line": line, "character": character } })
}

const TEXT: &str = "model Drain \"A vessel\"
  inner Oil.ISOVG46 oil;
  Hydraulic.Volume vessel(V = 1e-3, p_start = 1e6);
  Hydraulic.Orifise outlet(A = 1e-6);
  Hydraulic.Tank tank;
equation
  connect(vessel.port, outlet.port_a);
  connect(outlet.port_b, tank.port);
end Drain;
";

#[test]
fn a_session() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a circuit").join("Drain.mo");
    std::fs::create_dir(path.parent().expect("a parent")).expect("made");
    std::fs::write(&path, TEXT).expect("written");
    let mut editor = Editor::start(folder.path());
    editor.open(&path, TEXT);
    let said = editor.wait(&path, |d| !d.is_empty());
    assert_eq!(said[0]["code"], "E010", "{said:#?}");

    // the correction that the message proposes, applied as a change of the text
    let range = said[0]["range"].clone();
    let context = json!({ "diagnostics": said });
    let actions = editor.ask(
        "textDocument/codeAction",
        json!({ "textDocument": { "uri": uri(&path) }, "range": range, "context": context }),
    );
    let edit = &actions[0]["edit"]["changes"][uri(&path)][0];
    assert_eq!(edit["newText"], "Orifice");
    let change = json!({ "range": edit["range"], "text": edit["newText"] });
    let document = json!({ "uri": uri(&path), "version": 2 });
    editor.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": [change] }));
    editor.wait(&path, <[Value]>::is_empty);

    let hover = editor.ask("textDocument/hover", at(&path, 2, 26));
    let text = hover["contents"]["value"].as_str().expect("a text");
    assert!(text.contains("SI.Volume V") && text.contains("Here `0.001 m3 = 1000 ml`"), "{text}");

    let definition = editor.ask("textDocument/definition", at(&path, 3, 14));
    let shown = definition["uri"].as_str().expect("an address").strip_prefix("file://").expect("a file").to_owned();
    assert!(std::fs::read_to_string(&shown).expect("laid in the cache").contains("model Orifice"), "{shown}");

    let items = editor.ask("textDocument/completion", at(&path, 3, 12));
    let names: Vec<&str> =
        items["items"].as_array().expect("items").iter().filter_map(|i| i["label"].as_str()).collect();
    assert!(names.contains(&"Orifice") && names.contains(&"CheckValve"), "{names:?}");

    let mut rename = at(&path, 3, 20);
    rename["newName"] = json!("drain");
    let edits = editor.ask("textDocument/rename", rename);
    assert_eq!(edits["changes"][uri(&path)].as_array().map(Vec::len), Some(3), "{edits}");
    let mut shipped = at(&path, 3, 14);
    shipped["newName"] = json!("Hole");
    let refused = editor.ask_raw("textDocument/rename", shipped);
    assert_eq!(refused["error"]["message"], "`Orifice` ships with bramah");

    let hints = editor.ask(
        "textDocument/inlayHint",
        json!({ "textDocument": { "uri": uri(&path) }, "range": { "start": { "line": 0, "character": 0 }, "end": { "line": 20, "character": 0 } } }),
    );
    assert!(hints.to_string().contains("1000 ml"), "{hints}");

    let network = editor.ask("bramah/network", json!({ "uri": uri(&path) }));
    assert!(network["svg"].as_str().is_some_and(|svg| svg.starts_with("<svg")), "{network}");
    assert_eq!(network["model"], "Drain");

    // a port that is still open is drawn, too
    let open = format!(
        "{}  Hydraulic.Orifice other;\nequation\n  connect(other.port_a, tank.port);\nend Drain;\n",
        &TEXT.replace("Orifise", "Orifice")[..TEXT.find("equation").expect("a section")]
    );
    let document = json!({ "uri": uri(&path), "version": 3 });
    editor.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": [{ "text": open }] }));
    let network = editor.ask("bramah/network", json!({ "uri": uri(&path) }));
    assert!(network["svg"].as_str().is_some_and(|svg| svg.contains("other")), "{network}");

    for method in ["documentSymbol", "foldingRange", "semanticTokens/full", "formatting"] {
        let answer = editor.ask(
            &format!("textDocument/{method}"),
            json!({ "textDocument": { "uri": uri(&path) }, "options": { "tabSize": 2, "insertSpaces": true } }),
        );
        assert!(!answer.is_null(), "{method}");
    }
    let nothing = editor.ask_raw("textDocument/moniker", at(&path, 0, 0));
    assert_eq!(nothing["error"]["code"], -32601);
    editor.end();
}

/// An editor asks while the text is torn; the server stays.
#[test]
fn torn_texts_and_odd_requests() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("Drain.mo");
    let mut editor = Editor::start(folder.path());
    for (i, text) in
        ["", "model", "model Drain\n  Hydraulic.", "\u{1}\u{2}", "end;;;;", &TEXT[..150]].iter().enumerate()
    {
        if i == 0 {
            editor.open(&path, text);
        } else {
            let document = json!({ "uri": uri(&path), "version": i });
            editor.tell(
                "textDocument/didChange",
                json!({ "textDocument": document, "contentChanges": [{ "text": text }] }),
            );
        }
        for method in ["hover", "completion", "definition", "signatureHelp", "documentHighlight"] {
            editor.ask_raw(&format!("textDocument/{method}"), at(&path, 1, 12));
        }
        editor.ask_raw("textDocument/hover", at(&path, 999, 999));
        editor.ask_raw("textDocument/hover", at(&folder.path().join("missing.mo"), 0, 0));
        editor.ask_raw(
            "textDocument/hover",
            json!({ "textDocument": { "uri": "untitled:Untitled-1" }, "position": { "line": 0, "character": 0 } }),
        );
        editor.ask_raw("textDocument/hover", json!(7));
        editor.ask_raw("bramah/network", json!({ "uri": uri(&path) }));
    }
    editor.end();
}
