//! Conversion between byte offsets and positions of the protocol.
//!
//! The protocol counts lines and UTF-16 code units from 0; the compiler counts bytes. An offset or position beyond the
//! end is moved to the end, because the editor's text may be newer than the server's.

use bramah_syntax::diag::Span;
use lsp_types::{Position, Range};

/// The byte offset at which each line of a text begins. Build it once when many positions are needed.
#[derive(Clone, Debug)]
pub struct LineIndex(Vec<u32>);

impl LineIndex {
    /// Finds the line starts of a text.
    pub fn new(text: &str) -> LineIndex {
        let breaks = text.bytes().enumerate().filter(|(_, b)| *b == b'\n');
        LineIndex(std::iter::once(0).chain(breaks.map(|(i, _)| i as u32 + 1)).collect())
    }

    /// The position of a byte offset in the same text.
    pub fn position(&self, text: &str, offset: u32) -> Position {
        let mut at = (offset as usize).min(text.len());
        // An offset inside a character would make slicing panic; it moves to the start of the character.
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        // The first line starts at 0, so at least one start is not beyond the offset.
        let line = self.0.partition_point(|&s| s as usize <= at) - 1;
        let column: usize = text[self.0[line] as usize..at].chars().map(char::len_utf16).sum();
        Position::new(line as u32, column as u32)
    }

    /// The range of a span in the same text.
    pub fn range(&self, text: &str, span: Span) -> Range {
        Range::new(self.position(text, span.start), self.position(text, span.end))
    }
}

/// The position of a byte offset, for a single question.
pub fn position(text: &str, offset: u32) -> Position {
    LineIndex::new(text).position(text, offset)
}

/// The byte offset of a position. A column beyond the end of its line gives the end of the line.
///
/// A line beyond the end gives the end of the text.
pub fn offset(text: &str, position: Position) -> u32 {
    let mut start = 0;
    for _ in 0..position.line {
        match text[start..].find('\n') {
            Some(i) => start += i + 1,
            None => return text.len() as u32,
        }
    }
    let line = text[start..].split('\n').next().unwrap_or("");
    // A carriage return belongs to the line break, not to the line.
    let line = line.strip_suffix('\r').unwrap_or(line);
    let mut units = 0;
    for (i, c) in line.char_indices() {
        if units >= position.character as usize {
            return (start + i) as u32;
        }
        units += c.len_utf16();
    }
    (start + line.len()) as u32
}

/// The range of a span, for a single question.
pub fn range(text: &str, span: Span) -> Range {
    LineIndex::new(text).range(text, span)
}

#[cfg(test)]
mod tests {
    use super::{offset, position};
    use lsp_types::Position;

    #[test]
    fn bytes_and_places_meet() {
        let text = "a\u{e4}\u{1f600}b\r\nzwei\n";
        for (byte, line, column) in [(0, 0, 0), (1, 0, 1), (3, 0, 2), (7, 0, 4), (8, 0, 5), (10, 1, 0), (15, 2, 0)] {
            assert_eq!(position(text, byte), Position::new(line, column), "{byte}");
            assert_eq!(offset(text, Position::new(line, column)), byte, "{line}:{column}");
        }
        assert_eq!(offset(text, Position::new(1, 99)), 14);
        assert_eq!(offset(text, Position::new(9, 0)), text.len() as u32);
        assert_eq!(offset(text, Position::new(0, 99)), 8);
    }
}
