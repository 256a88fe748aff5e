//! Reads tables of numbers from files: CSV, and the text format of the Modelica Standard Library's tables (`#1`, then
//! `double name(rows, columns)`). Text enters, a [`TableMatrix`] leaves. The crate `model` calls [`read_table`] for
//! tables
//! in files.

use std::ops::Range;

use super::cells::{CellRows, TextCell};
use super::number;
use bramah_syntax::diag::{Code, Diagnostic, FileId, SourceText, Sources, Span};

/// The characters between numbers in the text format.
const PARTS: [char; 5] = [' ', '\t', ',', ';', '\r'];

/// A matrix that knows the place of each number in its file.
#[derive(Clone, Debug, PartialEq)]
pub struct TableMatrix {
    /// The file it was read from.
    pub file: FileId,
    /// The number of rows, at least 1.
    pub rows: usize,
    /// The number of columns, at least 1.
    pub columns: usize,
    /// The numbers row by row, all of them finite.
    pub values: Vec<f64>,
    /// The bytes of each number in the file.
    places: Vec<Range<usize>>,
}

/// The numbers of a table that are abscissae, and how they must be ordered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableAxes {
    /// The first column must not decrease: times, of which two equal ones are a jump.
    Times,
    /// The first column must increase.
    Column,
    /// The first column from the second row on, and the first row from the second column on, must increase.
    Grid,
}

impl TableAxes {
    /// The kind with this number in the library: 0, 1 and 2 in the order of the variants. `None` for other numbers.
    pub fn from_number(number: f64) -> Option<TableAxes> {
        [TableAxes::Times, TableAxes::Column, TableAxes::Grid]
            .into_iter()
            .zip([0.0, 1.0, 2.0])
            .find(|a| a.1 == number)
            .map(|a| a.0)
    }

    /// The smallest number of rows and columns that is useful.
    fn least(self) -> (usize, usize) {
        if self == TableAxes::Grid { (3, 3) } else { (2, 2) }
    }
}

/// Reads a table from a file whose text was added to `sources`.
///
/// A CSV file holds one table, whatever its name. A row of column names is skipped, and the corner of a map may be a
/// word
/// or empty. In the text format an empty `name` means the first table.
///
/// # Errors
/// [`Code::BadData`] with the place: no table of this name, a cell without a number, rows of different length.
pub fn read_table(sources: &Sources, file: FileId, name: &str) -> Result<TableMatrix, Box<Diagnostic>> {
    let source = sources.get(file);
    let text = source.text.strip_prefix('\u{feff}').unwrap_or(&source.text);
    // The first characters decide about the format, not the name of the file.
    if text.starts_with("#1") {
        return TextTableScanner { file, source, at: source.text.len() - text.len() }.table(name);
    }
    read_csv_table(file, source)
}

/// A diagnostic at some bytes of the file.
fn wrong(file: FileId, place: &Range<usize>, message: impl Into<String>, label: impl Into<String>) -> Box<Diagnostic> {
    let byte = |at: usize| u32::try_from(at).unwrap_or(u32::MAX);
    let span = Span { file, start: byte(place.start), end: byte(place.end) };
    Box::new(Diagnostic::new(Code::BadData, message).at(span, label))
}

/// The error that a cell is empty or no number.
fn no_number(file: FileId, place: &Range<usize>, word: &str) -> Box<Diagnostic> {
    let message =
        if word.is_empty() { "a cell of the table is empty".into() } else { format!("`{word}` is no number") };
    wrong(file, place, message, "a number is needed here")
}

/// A finite number from a cell. `None` if it is none.
/// `decimal_comma` is true if commas do not separate cells.
fn finite(word: &str, decimal_comma: bool) -> Option<f64> {
    number::parse(word, decimal_comma).filter(|value| value.is_finite())
}

/// Reads a CSV file as a table.
/// The number of columns is that of the first row.
fn read_csv_table(file: FileId, source: &SourceText) -> Result<TableMatrix, Box<Diagnostic>> {
    let mut rows = CellRows::new(&source.text);
    let comma = rows.decimal_comma();
    let mut matrix = TableMatrix { file, rows: 0, columns: 0, values: Vec::new(), places: Vec::new() };
    let mut cells: Vec<TextCell<'_>> = Vec::new();
    let mut first = true;
    while rows.next_row(&mut cells) {
        // A first row with words in all columns but the first, and no number there, is one of column names.
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
            // The corner of a map has no meaning; a number is stored to keep the matrix complete.
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

/// True if a cell exists and is a number.
fn is_number(cell: Option<&TextCell<'_>>, decimal_comma: bool) -> bool {
    cell.is_some_and(|c| finite(&c.text, decimal_comma).is_some())
}

/// A file in the text format, while it is read.
struct TextTableScanner<'a> {
    /// The file.
    file: FileId,
    /// Its path and text.
    source: &'a SourceText,
    /// The byte to be read next.
    at: usize,
}

/// The head of a table: `double name(rows, columns)`.
struct MatrixHeader<'a> {
    /// The name of the table.
    name: &'a str,
    /// The number of rows, at least 1.
    rows: usize,
    /// The number of columns, at least 1.
    columns: usize,
    /// The place of the head.
    place: Range<usize>,
}

impl<'a> TextTableScanner<'a> {
    /// Finds the table of a name and reads it. The error lists the names of the tables that there are.
    /// An empty name means the first table.
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

    /// The next line without its comment, and its place. `None` at the end of the text.
    fn line(&mut self) -> Option<(&'a str, Range<usize>)> {
        let whole = self.source.text[self.at..].split_inclusive('\n').next()?;
        let line = whole.split('#').next().unwrap_or("").trim_end();
        let place = self.at..self.at + line.len();
        self.at += whole.len();
        Some((line, place))
    }

    /// The head that a line is. `Ok(None)` if it is another line; the error is about a head that cannot be read.
    /// Both `double` and `float` are accepted, as in the Modelica Standard Library.
    fn head(&self, line: &'a str, place: &Range<usize>) -> Result<Option<MatrixHeader<'a>>, Box<Diagnostic>> {
        let line = line.trim_start();
        let Some(rest) = line.strip_prefix("double").or_else(|| line.strip_prefix("float")) else { return Ok(None) };
        let parts = rest.split_once('(').and_then(|(name, sizes)| Some((name.trim(), sizes.trim().strip_suffix(')')?)));
        let sizes = parts.and_then(|(name, sizes)| {
            let (rows, columns) = sizes.split_once(',')?;
            Some((name, rows.trim().parse().ok()?, columns.trim().parse().ok()?))
        });
        match sizes {
            // The product must not overflow; no memory is reserved for it before numbers are read.
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

    /// Reads the numbers below a head. Line breaks between them have no meaning.
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
            // The file ends, and this table has too few numbers.
            let Some((line, place)) = self.line() else { break };
            // The next table begins, and this one has too few numbers.
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
                // A number beyond the declared size is more likely a wrong size than a comment.
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
    /// Checks that the table is large enough, and that its abscissae are ordered as required.
    ///
    /// # Errors
    /// [`Code::BadData`] at the first number out of order.
    pub fn check(&self, axes: TableAxes) -> Result<(), Box<Diagnostic>> {
        let (rows, columns) = axes.least();
        // Fewer points have no interval to interpolate in.
        if self.rows < rows || self.columns < columns {
            let message = format!("a table of {} rows and {} columns is too small", self.rows, self.columns);
            return Err(wrong(self.file, &self.places[0], message, format!("at least {rows} of {columns} are needed")));
        }
        let first = usize::from(axes == TableAxes::Grid);
        self.follow((first..self.rows).map(|i| i * self.columns), axes)?;
        if axes == TableAxes::Grid { self.follow(1..self.columns, axes) } else { Ok(()) }
    }

    /// Checks the order of the abscissae at some indices of `values`.
    /// `axes` says whether equal neighbours are allowed.
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
