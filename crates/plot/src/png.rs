//! Renders an SVG picture as PNG. The fonts are part of the binary, so the result does not depend on the machine.

use std::sync::Arc;

use resvg::{tiny_skia, usvg};

/// Pixels for one SVG unit. Two keep text sharp on dense screens.
const SCALE: f32 = 2.0;

/// Renders an SVG text and returns the bytes of a PNG file.
///
/// # Errors
/// A sentence, when the text is no SVG or the picture is too large for memory.
pub fn write(svg: &str) -> Result<Vec<u8>, String> {
    // Fonts of the system are not loaded, because the picture would then differ between machines.
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
    fonts.load_font_data(epaint_default_fonts::HACK_REGULAR.to_vec());
    let options =
        usvg::Options { font_family: "Ubuntu".to_owned(), fontdb: Arc::new(fonts), ..usvg::Options::default() };
    let tree = usvg::Tree::from_str(svg, &options).map_err(|e| format!("the picture cannot be drawn: {e}"))?;
    let size = tree.size();
    let (width, height) = (size.width() * SCALE, size.height() * SCALE);
    let mut pixels = tiny_skia::Pixmap::new(width.ceil() as u32, height.ceil() as u32)
        .ok_or_else(|| format!("a picture of {width} by {height} pixels is too large"))?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
    pixels.encode_png().map_err(|e| format!("the picture cannot be packed: {e}"))
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_picture_has_pixels_and_text() {
        let svg = r##"<svg xmlns="http://www.w3.org/2000/svg" width="60" height="20" font-family="Ubuntu"><text y="15">pump</text></svg>"##;
        let png = super::write(svg).unwrap();
        assert_eq!(&png[1..4], b"PNG");
        let pixels = resvg::tiny_skia::Pixmap::decode_png(&png).unwrap();
        assert_eq!((pixels.width(), pixels.height()), (120, 40));
        assert!(pixels.pixels().iter().filter(|p| p.alpha() > 128).count() > 50);
    }
}
