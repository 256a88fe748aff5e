//! Splits a CSV text into cells that know their position, so that messages can point at them.
//! `recording` and `table` read files by it. The delimiter is recognised.

use std::borrow::Cow;
use std::ops::Range;

/// One cell of a row.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TextCell<'a> {
    /// Its text, without surrounding blanks and quotes. Owned only if quotes inside had to be replaced.
    pub text: Cow<'a, str>,
    /// The bytes of the cell in the file.
    pub place: Range<usize>,
}

/// Reads a text row by row. Empty lines and lines that begin with `#` are skipped.
#[derive(Clone, Debug)]
pub(super) struct CellRows<'a> {
    /// The complete text.
    text: &'a str,
    /// The byte to be read next.
    at: usize,
    /// The byte between cells.
    delimiter: u8,
}

impl<'a> CellRows<'a> {
    /// Starts at the first row, which decides about the delimiter: a tab if it has one, else a semicolon, else a comma.
    pub fn new(text: &'a str) -> Self {
        // A byte order mark is not part of the first name.
        let at = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
        let mut rows = CellRows { text, at, delimiter: b',' };
        rows.skip_remarks();
        let rest = &text[rows.at..];
        let head = unquoted(rest.lines().next().unwrap_or(""));
        rows.delimiter = [b'\t', b';'].into_iter().find(|&d| head.contains(d as char)).unwrap_or(b',');
        rows
    }

    /// True if numbers may have a decimal comma, because commas do not separate cells.
    pub fn decimal_comma(&self) -> bool {
        self.delimiter != b','
    }

    /// Moves to the first line that is neither empty nor a remark.
    fn skip_remarks(&mut self) {
        while let Some(line) = self.text[self.at..].split_inclusive('\n').next() {
            // A line of delimiters only is what spreadsheets write for an empty row.
            let empty = line.trim_matches([' ', '\t', '\r', '\n', ';', ',']).is_empty();
            if !empty && !line.trim_start().starts_with('#') {
                return;
            }
            self.at += line.len();
        }
    }

    /// Splits the next row into `cells`, which are replaced. False at the end of the text.
    pub fn next_row(&mut self, cells: &mut Vec<TextCell<'a>>) -> bool {
        cells.clear();
        self.skip_remarks();
        if self.at >= self.text.len() {
            return false;
        }
        loop {
            let (cell, end) = self.cell();
            cells.push(cell);
            self.at = end;
            match self.text.as_bytes().get(end) {
                Some(&b) if b == self.delimiter => self.at += 1,
                // A line end of Windows is one line end.
                Some(b'\r') if self.text.as_bytes().get(end + 1) == Some(&b'\n') => {
                    self.at += 2;
                    return true;
                }
                Some(_) => {
                    self.at += 1;
                    return true;
                }
                None => return true,
            }
        }
    }

    /// The cell at the current position, and the position of the delimiter or line end after it.
    fn cell(&self) -> (TextCell<'a>, usize) {
        let bytes = self.text.as_bytes();
        let blanks = bytes[self.at..].iter().take_while(|&&b| b == b' ').count();
        if bytes.get(self.at + blanks) == Some(&b'"') {
            return self.quoted(self.at + blanks);
        }
        let end = self.end_of_plain(self.at);
        let raw = &self.text[self.at..end];
        let start = self.at + (raw.len() - raw.trim_start().len());
        let text = raw.trim();
        (TextCell { text: Cow::Borrowed(text), place: start..start + text.len() }, end)
    }

    /// The position of the next delimiter or line end.
    fn end_of_plain(&self, from: usize) -> usize {
        let stop = |&b: &u8| b == self.delimiter || b == b'\n' || b == b'\r';
        self.text.as_bytes()[from..].iter().position(stop).map_or(self.text.len(), |i| from + i)
    }

    /// A cell in quotes, whose opening mark is at `open`. Doubled quotes inside stand for one.
    /// A quote that is never closed extends to the end of the text.
    fn quoted(&self, open: usize) -> (TextCell<'a>, usize) {
        let bytes = self.text.as_bytes();
        let mut at = open + 1;
        let close = loop {
            match bytes[at..].iter().position(|&b| b == b'"') {
                None => break self.text.len(),
                Some(i) if bytes.get(at + i + 1) == Some(&b'"') => at += i + 2,
                Some(i) => break at + i,
            }
        };
        let inner = &self.text[open + 1..close];
        let text = if inner.contains('"') { Cow::Owned(inner.replace("\"\"", "\"")) } else { Cow::Borrowed(inner) };
        let after = (close + 1).min(self.text.len());
        // Text between the closing quote and the delimiter is dropped.
        (TextCell { text, place: open..after }, self.end_of_plain(after))
    }
}

/// A line without its quoted parts.
fn unquoted(line: &str) -> String {
    line.split('"').step_by(2).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &str) -> Vec<Vec<String>> {
        let mut rows = CellRows::new(text);
        let mut out = Vec::new();
        let mut cells = Vec::new();
        while rows.next_row(&mut cells) {
            out.push(cells.iter().map(|c| c.text.to_string()).collect());
        }
        out
    }

    #[test]
    fn delimiters_quotes_remarks_and_line_ends() {
        assert_eq!(
            all("\u{feff}# made by X\r\ntime,\"A[1,2]\", b\r\n\r\n0, 1 ,2\r\n"),
            [["time", "A[1,2]", "b"], ["0", "1", "2"]]
        );
        assert_eq!(all("t;x\n0,5;1,5"), [["t", "x"], ["0,5", "1,5"]]);
        assert_eq!(all("t\tx;y\n0\t"), [["t", "x;y"], ["0", ""]]);
        assert_eq!(all("t,\"a\"\"b\"\n1,2\n"), [["t", "a\"b"], ["1", "2"]]);
    }

    #[test]
    fn damaged_texts_end() {
        assert_eq!(all(""), Vec::<Vec<String>>::new());
        assert_eq!(all("t,\"open\n0,1\n"), [["t", "open\n0,1\n"]]);
        assert_eq!(all("\n\n#\n"), Vec::<Vec<String>>::new());
    }

    #[test]
    fn cells_know_their_place() {
        let text = "t, x\n0,  12 \n";
        let mut rows = CellRows::new(text);
        let mut cells = Vec::new();
        rows.next_row(&mut cells);
        rows.next_row(&mut cells);
        assert_eq!(&text[cells[1].place.clone()], "12");
    }

    proptest::proptest! {
        #[test]
        fn never_panics(text in "(?s)[\"\r\n,;\t# a1é]{0,60}") {
            all(&text);
        }
    }
}
