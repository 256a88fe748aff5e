//! Who may ask, how much, and for which files.

use std::path::{Component, Path, PathBuf};

use tiny_http::{Method, Request};

use super::http::HttpRefusal;

/// The largest upload, in bytes.
pub(super) const LARGEST: u64 = 200 << 20;

/// Lets in requests of the page itself. A browser names the host it meant: a name that leads to this machine by a trick
/// of its DNS server is not ours. It also names the site a request comes from.
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
    let elsewhere = header("Sec-Fetch-Site").is_some_and(|site| site != "same-origin" && site != "none");
    if origin.is_some_and(|o| !ours(o)) || elsewhere && *request.method() != Method::Get {
        return Err(HttpRefusal::new(403, "this server answers its own page only"));
    }
    if request.body_length().is_some_and(|length| length as u64 > LARGEST) {
        return Err(too_large());
    }
    Ok(())
}

/// Says how large an upload may be.
pub(super) fn too_large() -> HttpRefusal {
    HttpRefusal::new(413, format!("the file is larger than {} MB", LARGEST >> 20))
}

/// A path below the folder, for a name relative to it. Links that lead out of the folder do not count.
pub(super) fn inside(root: &Path, name: &str) -> Result<PathBuf, HttpRefusal> {
    let refused = || HttpRefusal::new(403, format!("`{name}` is not in the folder that is served"));
    let plain = |c: Component<'_>| matches!(c, Component::Normal(_) | Component::CurDir);
    if !Path::new(name).components().all(plain) || name.contains('\\') {
        return Err(refused());
    }
    let path = root.join(name);
    // Of a file that is not there yet, the folder it will lie in counts.
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
