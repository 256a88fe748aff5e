//! Tables of numbers in files: CSV, and the text format of Modelica's tables (`#1`, then `double name(rows, columns)`).

use std::ops::Range;

use super::cells::{CellRows, TextCell};
use super::number;
use bramah_syntax::diag::{Code, Diagnostic, FileId, SourceText, Sources, Span};

/// What parts numbers in the text format.
const PARTS: [char; 5] = [' ', '\t', ',', ';', '\r'];

/// A matrix that knows where in its file each number stands.
#[derive(Clone, Debug, PartialEq)]
pub struct TableMatrix {
    /// The file.
    pub file: FileId,
    /// Number of rows, at least 1.
    pub rows: usize,
    /// Number of columns, at least 1.
    pub columns: usize,
    /// The numbers row by row, all finite.
    pub values: Vec<f64>,
    /// The bytes of each.
    places: Vec<Range<usize>>,
}

/// Which numbers of a table are abscissae, and how they must follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableAxes {
    /// The first column does not decrease: times, of which two equal ones make a jump.
    Times,
    /// The first column increases.
    Column,
    /// The first column from the second row on, and the first row from the second column on, increase.
    Grid,
}

impl TableAxes {
    /// By the number that stands for it in the library: 0, 1 and 2 in the order of the variants.
    pub fn from_number(number: f64) -> Option<TableAxes> {
        [TableAxes::Times, TableAxes::Column, TableAxes::Grid]
            .into_iter()
            .zip([0.0, 1.0, 2.0])
            .find(|a| a.1 == number)
            .map(|a| a.0)
    }

    /// The smallest table of use.
    fn least(self) -> (usize, usize) {
        if self == TableAxes::Grid { (3, 3) } else { (2, 2) }
    }
}

/// Reads a table from a file that was added to `sources`. A CSV file holds one table, whatever its name; a row of
/// column names above it is passed over, and the corner of a map may be a word or empty. In the text format an empty
/// `name` means the first table.
///
/// # Errors
/// [`Code::BadData`] with the place: no table of this name, no number, rows of different length.
pub fn read_table(sources: &Sources, file: FileId, name: &str) -> Result<TableMatrix, Box<Diagnostic>> {
    let source = sources.get(file);
    let text = source.text.strip_prefix('\u{feff}').unwrap_or(&source.text);
    if text.starts_with("#1") {
        return TextTableScanner { file, source, at: source.text.len() - text.len() }.table(name);
    }
    read_csv_table(file, source)
}

fn wrong(file: FileId, place: &Range<usize>, message: impl Into<String>, label: impl Into<String>) -> Box<Diagnostic> {
    let byte = |at: usize| u32::try_from(at).unwrap_or(u32::MAX);
    let span = Span { file, start: byte(place.start), end: byte(place.end) };
    Box::new(Diagnostic::new(Code::BadData, message).at(span, label))
}

/// `no number` at a place.
fn no_number(file: FileId, place: &Range<usize>, word: &str) -> Box<Diagnostic> {
    let message =
        if word.is_empty() { "a cell of the table is empty".into() } else { format!("`{word}` is no number") };
    wrong(file, place, message, "a number is needed here")
}

fn finite(word: &str, decimal_comma: bool) -> Option<f64> {
    number::parse(word, decimal_comma).filter(|value| value.is_finite())
}

fn read_csv_table(file: FileId, source: &SourceText) -> Result<TableMatrix, Box<Diagnostic>> {
    let mut rows = CellRows::new(&source.text);
    let comma = rows.decimal_comma();
    let mut matrix = TableMatrix { file, rows: 0, columns: 0, values: Vec::new(), places: Vec::new() };
    let mut cells: Vec<TextCell<'_>> = Vec::new();
    let mut first = true;
    while rows.next_row(&mut cells) {
        let words = std::mem::take(&mut first).then(|| {
            cells.iter().skip(1).all(|c| finite(&c.text, comma).is_none()) && !is_number(cells.first(), comma)
        });
        if words == Some(true) {
            continue;
        }
        if matrix.rows == 0 {
            matrix.columns = cells.len();
        } else if cells.len() != matrix.columns {
            let place = cells[0].place.start..cells[cells.len() - 1].place.end;
            let message = format!("the table has {} columns, and this row {}", matrix.columns, cells.len());
            return Err(wrong(file, &place, message, "this row"));
        }
        for (j, cell) in cells.iter().enumerate() {
            // the corner of a map says nothing
            let corner = matrix.rows == 0 && j == 0 && cells.len() > 2;
            let value = finite(&cell.text, comma).or(corner.then_some(0.0));
            matrix.values.push(value.ok_or_else(|| no_number(file, &cell.place, &cell.text))?);
            matrix.places.push(cell.place.clone());
        }
        matrix.rows += 1;
    }
    match matrix.rows {
        0 => Err(wrong(file, &(0..0), "the file holds no table", "rows of numbers are expected here")),
        _ => Ok(matrix),
    }
}

fn is_number(cell: Option<&TextCell<'_>>, decimal_comma: bool) -> bool {
    cell.is_some_and(|c| finite(&c.text, decimal_comma).is_some())
}

/// A file in the text format, read from a place on.
struct TextTableScanner<'a> {
    file: FileId,
    source: &'a SourceText,
    at: usize,
}

/// `double name(rows, columns)`.
struct MatrixHeader<'a> {
    name: &'a str,
    rows: usize,
    columns: usize,
    place: Range<usize>,
}

impl<'a> TextTableScanner<'a> {
    fn table(mut self, name: &str) -> Result<TableMatrix, Box<Diagnostic>> {
        let start = self.at;
        let mut known = Vec::new();
        while let Some((line, place)) = self.line() {
            let Some(head) = self.head(line, &place)? else { continue };
            if name.is_empty() || head.name == name {
                return self.numbers(&head);
            }
            known.push(format!("`{}`", head.name));
        }
        let message = match name {
            "" => "the file holds no table".to_owned(),
            _ => format!("the file holds no table `{name}`"),
        };
        let mut diagnostic = *wrong(self.file, &(start..start + 2), message, "looked for from here on");
        diagnostic = if known.is_empty() {
            diagnostic.help("a table begins with a line such as `double curve(3, 2)`: name, rows, columns")
        } else {
            diagnostic.help(format!("it holds {}", known.join(", ")))
        };
        Err(Box::new(diagnostic))
    }

    /// The next line without its remark, and its place.
    fn line(&mut self) -> Option<(&'a str, Range<usize>)> {
        let whole = self.source.text[self.at..].split_inclusive('\n').next()?;
        let line = whole.split('#').next().unwrap_or("").trim_end();
        let place = self.at..self.at + line.len();
        self.at += whole.len();
        Some((line, place))
    }

    fn head(&self, line: &'a str, place: &Range<usize>) -> Result<Option<MatrixHeader<'a>>, Box<Diagnostic>> {
        let line = line.trim_start();
        let Some(rest) = line.strip_prefix("double").or_else(|| line.strip_prefix("float")) else { return Ok(None) };
        let parts = rest.split_once('(').and_then(|(name, sizes)| Some((name.trim(), sizes.trim().strip_suffix(')')?)));
        let sizes = parts.and_then(|(name, sizes)| {
            let (rows, columns) = sizes.split_once(',')?;
            Some((name, rows.trim().parse().ok()?, columns.trim().parse().ok()?))
        });
        match sizes {
            Some((name, rows, columns)) if rows > 0 && columns > 0 && rows <= usize::MAX / columns => {
                Ok(Some(MatrixHeader { name, rows, columns, place: place.clone() }))
            }
            _ => Err(wrong(
                self.file,
                place,
                "the head of a table cannot be read",
                "`double name(rows, columns)` is expected",
            )),
        }
    }

    /// The numbers below a head, in rows of any form.
    fn numbers(mut self, head: &MatrixHeader<'a>) -> Result<TableMatrix, Box<Diagnostic>> {
        let count = head.rows * head.columns;
        let mut matrix = TableMatrix {
            file: self.file,
            rows: head.rows,
            columns: head.columns,
            values: Vec::new(),
            places: Vec::new(),
        };
        while matrix.values.len() < count {
            let Some((line, place)) = self.line() else { break };
            if self.head(line, &place).is_ok_and(|head| head.is_some()) {
                break;
            }
            let mut next = place.start;
            for piece in line.split_inclusive(PARTS) {
                let word = piece.trim_end_matches(PARTS);
                let at = next..next + word.len();
                next += piece.len();
                if word.is_empty() {
                    continue;
                }
                if matrix.values.len() == count {
                    let message = format!("the table `{}` has more than its {count} numbers", head.name);
                    return Err(wrong(self.file, &at, message, "one too many"));
                }
                matrix.values.push(finite(word, false).ok_or_else(|| no_number(self.file, &at, word))?);
                matrix.places.push(at);
            }
        }
        if matrix.values.len() == count {
            return Ok(matrix);
        }
        let (name, have) = (head.name, matrix.values.len());
        let message = format!("the table `{name}` has {count} numbers by its head, and only {have} follow");
        Err(wrong(self.file, &head.place, message, "this head"))
    }
}

impl TableMatrix {
    /// Whether the table is large enough and its abscissae follow each other as they must.
    ///
    /// # Errors
    /// [`Code::BadData`] at the number that does not.
    pub fn check(&self, axes: TableAxes) -> Result<(), Box<Diagnostic>> {
        let (rows, columns) = axes.least();
        if self.rows < rows || self.columns < columns {
            let message = format!("a table of {} rows and {} columns is too small", self.rows, self.columns);
            return Err(wrong(self.file, &self.places[0], message, format!("at least {rows} of {columns} are needed")));
        }
        let first = usize::from(axes == TableAxes::Grid);
        self.follow((first..self.rows).map(|i| i * self.columns), axes)?;
        if axes == TableAxes::Grid { self.follow(1..self.columns, axes) } else { Ok(()) }
    }

    fn follow(&self, axis: impl Iterator<Item = usize>, axes: TableAxes) -> Result<(), Box<Diagnostic>> {
        let mut before: Option<f64> = None;
        for i in axis {
            let x = self.values[i];
            let (fits, must) = match axes {
                TableAxes::Times => (before.is_none_or(|b| x >= b), "must not decrease"),
                _ => (before.is_none_or(|b| x > b), "must increase"),
            };
            if !fits {
                let message = format!("the abscissae of the table {must}");
                let label = format!("{} follows {}", number::text(x), number::text(before.unwrap_or(x)));
                return Err(wrong(self.file, &self.places[i], message, label));
            }
            before = Some(x);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bramah_syntax::diag::render::short_list;

    /// The table, or what is wrong with it.
    fn read(text: &str, name: &str, axes: TableAxes) -> String {
        let mut sources = Sources::default();
        let file = sources.add("t.txt", text);
        match read_table(&sources, file, name).and_then(|m| m.check(axes).map(|()| m)) {
            Ok(m) => format!("{} x {}: {:?}\n", m.rows, m.columns, m.values),
            Err(d) => short_list(&sources, &[*d]),
        }
    }

    #[test]
    fn both_formats() {
        let listing = "#1\n# pump\ndouble a(2,2) # first\n 0 1\n 1 2\nfloat map(3, 3)\n0 0 1\n0, 1, 2\n1 3;4\n";
        let said = [
            read(listing, "", TableAxes::Column),
            read(listing, "map", TableAxes::Grid),
            read("\u{feff}time [s];p\r\n0;1,5\r\n1;2\r\n", "any", TableAxes::Column),
            read("n\\p,0,1\n0,1,2\n1,3,4\n", "", TableAxes::Grid),
            read("0,0\n1,2\n1,3\n", "", TableAxes::Times),
        ];
        insta::assert_snapshot!(said.concat());
    }

    #[test]
    fn mistakes_have_a_place() {
        let said = [
            read("", "", TableAxes::Column),
            read("x,y\n", "", TableAxes::Column),
            read("0,1\n1\n", "", TableAxes::Column),
            read("0,1\n1,a\n", "", TableAxes::Column),
            read("0,1\n1,\n", "", TableAxes::Column),
            read("0,1\n2,1\n1,1\n", "", TableAxes::Column),
            read("0,1\n0,1\n", "", TableAxes::Column),
            read("0,1\n-1,1\n", "", TableAxes::Times),
            read("0,2,1\n0,1,2\n1,3,4\n", "", TableAxes::Grid),
            read("0,1\n", "", TableAxes::Column),
            read("0,inf\n1,2\n", "", TableAxes::Column),
            read("#1\n", "", TableAxes::Column),
            read("#1\ndouble a(2,2)\n0 1\n1 2\n", "b", TableAxes::Column),
            read("#1\ndouble a(2;2)\n", "", TableAxes::Column),
            read("#1\ndouble a(2,2)\n0 1\n1\ndouble b(1,1)\n0\n", "a", TableAxes::Column),
            read("#1\ndouble a(2,2)\n0 1\n1 x\n", "a", TableAxes::Column),
            read("#1\ndouble a(1,2)\n0 1 2\n", "a", TableAxes::Column),
        ];
        insta::assert_snapshot!(said.concat());
    }

    proptest::proptest! {
        #[test]
        fn never_panics(text in "(?s)(#1\n)?(double |a|\\(|2|,|\\)|;| |\n|#|1e9|é|-){0,40}") {
            for axes in [TableAxes::Times, TableAxes::Column, TableAxes::Grid] {
                read(&text, "", axes);
            }
        }
    }
}
