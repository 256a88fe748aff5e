//! Symbols of components, after ISO 1219-1 and the conventions of other fields.
//!
//! The files are `symbols/CLASS.svg` with the full name of the class. Each is drawn in a field of 48 by 48 units in the
//! colour of the surrounding text.

use include_dir::{Dir, include_dir};

/// The symbol files, embedded at compile time.
static SYMBOLS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/src/network/symbols");

/// Side of the field of a symbol.
pub const FIELD: f64 = 48.0;

/// The drawing of the first class that has a symbol; `None` when none has. Pass the class of a component, followed by
/// its base classes.
pub fn symbol<'c>(classes: impl IntoIterator<Item = &'c str>) -> Option<&'static str> {
    classes.into_iter().find_map(|class| {
        let text = SYMBOLS.get_file(format!("{class}.svg"))?.contents_utf8()?;
        // The symbol is placed into a picture, so only the content of its outer element is used.
        let inner = text.find("viewBox=\"0 0 48 48\">")? + "viewBox=\"0 0 48 48\">".len();
        text.get(inner..text.rfind("</svg>")?)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every file is named after a class of the library and holds shapes only.
    #[test]
    fn symbols_belong_to_classes() {
        use bramah_syntax::world::World;
        for file in SYMBOLS.files() {
            let class = file.path().file_stem().expect("a name").to_string_lossy().into_owned();
            let source = format!("components/{}.mo", class.replace('.', "/"));
            let known = bramah_model::shipped::ShippedWorld.read(std::path::Path::new(&source));
            assert!(known.is_ok(), "{class} is no class of the library");
            let drawn = symbol([class.as_str()]).unwrap_or_else(|| panic!("{class} cannot be read"));
            let element = |text: &str| ["g", "path", "circle", "rect", "/g"].iter().any(|e| text.starts_with(e));
            assert!(drawn.split('<').skip(1).all(element), "{class} holds more than shapes");
            crate::png::write(file.contents_utf8().expect("text")).unwrap_or_else(|e| panic!("{class}: {e}"));
        }
        assert!(SYMBOLS.files().count() > 250);
    }

    #[test]
    fn a_class_takes_the_symbol_of_what_it_extends() {
        let own = symbol(["Hydraulic.Bases.Machine"]);
        assert!(own.is_some());
        assert_eq!(symbol(["Mine.Pump", "Hydraulic.Bases.Machine"]), own);
        assert_eq!(symbol(["Mine.Pump"]), None);
    }
}
