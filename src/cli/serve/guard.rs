//! The security checks of the server: which requests are answered, how large they may be, and which files they reach.
//!
//! The server runs with the user's rights, and any site in the user's browser can send requests to 127.0.0.1. These
//! checks keep other sites out and paths inside the served folder.

use std::path::{Component, Path, PathBuf};

use tiny_http::{Method, Request};

use super::http::HttpRefusal;

/// The largest body of a request in bytes (200 MiB).
pub(super) const LARGEST: u64 = 200 << 20;

/// Accepts requests of the server's own page and refuses others with 403, or 413 for a too large body.
///
/// The `Host` header must name this machine and port. This stops DNS rebinding, where a foreign name resolves to
/// 127.0.0.1. `Origin` and `Sec-Fetch-Site` name the site that sent the request; browsers do not let scripts change
/// them.
pub(super) fn allowed(request: &Request, port: u16) -> Result<(), HttpRefusal> {
    let header = |name: &str| {
        let found = request.headers().iter().find(|h| h.field.as_str().as_str().eq_ignore_ascii_case(name));
        found.map(|h| h.value.as_str())
    };
    let hosts = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{port}"));
    if !header("Host").is_some_and(|host| hosts.iter().any(|h| h == host)) {
        return Err(HttpRefusal::new(403, "this server answers this machine only"));
    }
    let origin = header("Origin");
    let ours = |origin: &str| origin.strip_prefix("http://").is_some_and(|o| hosts.iter().any(|h| h == o));
    // `none` means that the user typed the address. Programs other than browsers send no such header.
    let elsewhere = header("Sec-Fetch-Site").is_some_and(|site| site != "same-origin" && site != "none");
    // A plain link to the page from elsewhere is a GET and harmless; it must not start or write anything.
    if origin.is_some_and(|o| !ours(o)) || elsewhere && *request.method() != Method::Get {
        return Err(HttpRefusal::new(403, "this server answers its own page only"));
    }
    // Known already from the header. A body without a stated length is limited while it is read.
    if request.body_length().is_some_and(|length| length as u64 > LARGEST) {
        return Err(too_large());
    }
    Ok(())
}

/// The refusal (413) of a body that is too large.
pub(super) fn too_large() -> HttpRefusal {
    HttpRefusal::new(413, format!("the file is larger than {} MB", LARGEST >> 20))
}

/// The path in the served folder for a relative name. `Err` (403): it leads out of the folder.
///
/// `root` must be canonical. The file itself need not exist.
pub(super) fn inside(root: &Path, name: &str) -> Result<PathBuf, HttpRefusal> {
    let refused = || HttpRefusal::new(403, format!("`{name}` is not in the folder that is served"));
    // No `..`, no absolute path, no drive. A backslash separates folders on Windows.
    let plain = |c: Component<'_>| matches!(c, Component::Normal(_) | Component::CurDir);
    if !Path::new(name).components().all(plain) || name.contains('\\') {
        return Err(refused());
    }
    let path = root.join(name);
    // Links are resolved, as one may lead out of the folder. A new file does not exist yet, so its nearest existing
    // folder is checked instead.
    let there = path.ancestors().find_map(|p| p.canonicalize().ok()).ok_or_else(refused)?;
    if there.starts_with(root) { Ok(path) } else { Err(refused()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_stay_inside() {
        let outer = tempfile::tempdir().unwrap();
        let root = outer.path().canonicalize().unwrap().join("served");
        std::fs::create_dir_all(root.join("rig")).unwrap();
        std::fs::write(outer.path().join("secret.csv"), "t\n0").unwrap();
        #[cfg(unix)]
        std::os::unix::fs::symlink(outer.path(), root.join("out")).unwrap();
        for fine in ["", "a.csv", "rig/a.csv", "./rig", "new/deep/a.csv"] {
            assert!(inside(&root, fine).is_ok(), "{fine}");
        }
        for wrong in ["..", "../secret.csv", "rig/../../secret.csv", "/etc/passwd", "a\\..\\b", "out/secret.csv"] {
            assert_eq!(inside(&root, wrong).unwrap_err().status, 403, "{wrong}");
        }
    }
}
