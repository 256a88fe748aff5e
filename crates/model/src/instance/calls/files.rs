//! Tables that models read from files while they are built.
//!
//! The external functions behind `Signal.Functions.readTable` and `tableSize` are handled here.
//! Their results are known before the run, so array sizes may depend on them. Files come through the library's `World`.

use crate::instance::call::Callee;
use crate::instance::value::ModelicaValue;
use crate::instance::{ExternalCalls, InstanceNode, LookupContext};
use bramah_expr::types::ScalarType;
use bramah_results::table::{TableAxes, TableMatrix, read_table};
use bramah_syntax::ast::{ClassBody, Expr, ExprKind, Ident};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use bramah_syntax::symbol::Symbol;
use std::rc::Rc;

/// An external function that reads tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::instance) enum FileFunction {
    /// The numbers of rows and columns: `bramah_table_size`.
    Size,
    /// The numbers in the table: `bramah_table_read`.
    Read,
}

/// Where a file is named, for messages.
#[derive(Clone, Copy, Debug)]
pub(in crate::instance) struct FileReference {
    /// The call of the function.
    pub call: Span,
    /// The file name, if it is an argument or the value of a parameter that the call passes on.
    pub given: Option<Span>,
}

impl FileReference {
    /// The place to show in messages about the file: the file name if it is known, else the call.
    fn span(&self) -> Span {
        self.given.unwrap_or(self.call)
    }
}

impl<'a> ExternalCalls<'_, 'a, '_> {
    /// Which function for tables an external function is, by its C name. `None` for all others.
    /// The C name is searched in the text after `external`, as a complete word.
    pub(in crate::instance) fn file_function(&self, callee: &Callee<'a>) -> Option<FileFunction> {
        let ClassBody::Long(body) = &callee.template.bases.first()?.ast.body else { return None };
        let text = body.external_text.as_deref()?;
        let called = |name: &str| text.split(|c: char| !(c.is_alphanumeric() || c == '_')).any(|word| word == name);
        match () {
            () if called("bramah_table_size") => Some(FileFunction::Size),
            () if called("bramah_table_read") => Some(FileFunction::Read),
            () => None,
        }
    }

    /// The place of a call whose first argument names the file.
    /// If the argument is a parameter, its binding equation is the place to show.
    /// An argument that is a literal or another expression is itself the place to show.
    pub(in crate::instance) fn file_place(
        &mut self,
        first: Option<&'a Expr>,
        view: LookupContext,
        call: Span,
    ) -> FileReference {
        let given = first.and_then(|e| match &e.kind {
            ExprKind::Reference(r) if r.parts.len() == 1 => {
                let index = *self.instance.scope(view.scope).template.by_name.get(&r.parts[0].name.name)?;
                let node = self.instance.builder().component(view.scope, index)?;
                let InstanceNode::Var(i) = *self.instance.node(node) else { return None };
                self.instance.variables[i as usize].binding.as_ref().map(|b| b.expr.span)
            }
            _ => Some(e.span),
        });
        FileReference { call, given }
    }

    /// Calls a function for tables with evaluated arguments. `None` after a message.
    /// The call is carried out at once: it never becomes part of the flat model.
    pub(in crate::instance) fn call_file_function(
        &mut self,
        function: FileFunction,
        callee: &Callee<'a>,
        positional: Vec<ModelicaValue>,
        named: Vec<(Ident, ModelicaValue)>,
        place: FileReference,
    ) -> Option<ModelicaValue> {
        self.instance
            .calls()
            .with_inputs(callee, positional, named, place.call, |s| s.externals().carry_out(function, callee, place))
    }

    /// Reads a table, or its size, with the inputs bound as locals. `None` after a message.
    ///
    /// The numbers of rows and columns given to `readTable` must be those of the file.
    ///
    /// `readTable` has the inputs `fileName`, `tableName`, `axes`, `m` and `n`; `tableSize` the first two.
    /// `axes` tells which values must be in increasing order: 0 for times, 1 for the first column, 2 for a grid.
    /// A size that differs from the file is an error that names both.
    fn carry_out(
        &mut self,
        function: FileFunction,
        callee: &Callee<'a>,
        place: FileReference,
    ) -> Option<ModelicaValue> {
        let (file, name) = (self.text_input("fileName", callee, place)?, self.text_input("tableName", callee, place)?);
        let matrix = self.table(&file, &name, place)?;
        let whole = |n: usize| n as f64;
        // Sizes are answered without checking the contents.
        if function == FileFunction::Size {
            let sizes = [matrix.rows, matrix.columns]
                .map(|n| ModelicaValue::Scalar(self.instance.exprs.num(whole(n)), ScalarType::Integer));
            return Some(ModelicaValue::array(vec![2], sizes.to_vec()));
        }
        let [axes, rows, columns] = ["axes", "m", "n"].map(|input| self.number_input(input));
        let axes = axes.and_then(TableAxes::from_number);
        let (Some(axes), Some(rows), Some(columns)) = (axes, rows, columns) else {
            let message = format!("`{}` needs known sizes, and 0, 1 or 2 for `axes`", callee.name);
            return self.instance.fail(Code::BadCall, &message, place.call);
        };
        // The library tells by `axes` which order of values the interpolation relies on.
        if let Err(d) = matrix.check(axes) {
            self.instance.report(d.at(place.span(), "the file is named here"));
            return None;
        }
        if (whole(matrix.rows), whole(matrix.columns)) != (rows, columns) {
            let have = format!("{} rows and {} columns", matrix.rows, matrix.columns);
            let message = format!("the table in `{file}` has {have}, and {rows} rows and {columns} columns are needed");
            return self.instance.fail(Code::BadData, &message, place.span());
        }
        let values = matrix
            .values
            .iter()
            .map(|&x| ModelicaValue::Scalar(self.instance.exprs.num(x), ScalarType::Real))
            .collect();
        Some(ModelicaValue::array(vec![matrix.rows, matrix.columns], values))
    }

    /// The value of an input of the function. `None` if it has no such input.
    fn input_value(&self, name: &str) -> Option<&ModelicaValue> {
        self.instance.local(Symbol::new(name)).map(|i| &self.instance.eval.locals[i].1)
    }

    /// The number of an input, if it is known.
    fn number_input(&self, name: &str) -> Option<f64> {
        self.input_value(name)?.as_number(&self.instance.exprs)
    }

    /// The text of an input that must be known. `None` after a message.
    fn text_input(&mut self, name: &str, callee: &Callee<'a>, place: FileReference) -> Option<String> {
        let text = self.input_value(name).and_then(|v| v.as_text(&self.instance.exprs));
        if text.is_none() {
            let message = format!("`{name}` of `{}` must be known before the run", callee.name);
            return self.instance.fail(Code::NotConstant, &message, place.call);
        }
        text
    }

    /// The table `name` of a file, which is read once. An empty name means the only one. `None` after a message.
    /// A file that cannot be read, or a table that is not in it, is reported at the place of the file name.
    /// The first read parses it; later calls get the same matrix.
    pub(in crate::instance) fn table(
        &mut self,
        file: &str,
        name: &str,
        place: FileReference,
    ) -> Option<Rc<TableMatrix>> {
        // The library finds the file relative to the model and remembers it as one that the model depends on.
        let id = match self.instance.library.data(file) {
            Ok(id) => id,
            Err(why) => {
                let d = Diagnostic::new(Code::FileAccess, format!("cannot read `{file}`: {why}"))
                    .at(place.span(), "the file is named here")
                    .help("a relative path begins at the folder of the model's file, or else where the command runs; `modelica://Package/...` begins at the folder of a package");
                self.instance.report(d);
                return None;
            }
        };
        if let Some(matrix) = self.instance.functions.tables.get(&(id, name.to_owned())) {
            return Some(matrix.clone());
        }
        match read_table(&self.instance.library.sources, id, name) {
            Ok(matrix) => {
                let matrix = Rc::new(matrix);
                self.instance.functions.tables.insert((id, name.to_owned()), matrix.clone());
                Some(matrix)
            }
            Err(d) => {
                self.instance.report(d.at(place.span(), "the file is named here"));
                None
            }
        }
    }
}
