//! A component `FMU(file = "controller.fmu")`: its class is made of what the unit says of itself.

use crate::instance::files::FileReference;
use crate::instance::lookup::LookupResult;
use crate::instance::modifiers::{Modifier, ModifierKind};
use crate::instance::value::ModelicaValue;
use crate::instance::{ClassRef, ComponentBuilder};
use crate::resolve::ClassId;
use bramah_external::mockup::ImportedFmu;
use bramah_external::{ExternalObject, ExternalValue};
use bramah_syntax::ast::Expr;
use bramah_syntax::diag::{Code, Diagnostic, Span};
use std::sync::Arc;

/// The class that stands for all units, and where it ships.
const NAME: &str = "FMU";
const FILE: &str = "components/FMU.mo";

/// A unit that was opened, with its class.
pub(in crate::instance) struct FmuClass {
    pub unit: Arc<ImportedFmu>,
    class: ClassId,
}

impl<'a> ComponentBuilder<'_, 'a, '_> {
    /// What a component's class is: for one of `FMU` that of its unit.
    pub(in crate::instance) fn with_unit(
        &mut self,
        found: LookupResult<'a>,
        args: &[Modifier<'a>],
        declared: Span,
    ) -> Option<LookupResult<'a>> {
        match found {
            LookupResult::Class(class) if self.stands_for_units(class.class) => {
                self.class_of_unit(&class, args, declared).map(LookupResult::Class)
            }
            _ => Some(found),
        }
    }

    fn stands_for_units(&self, class: ClassId) -> bool {
        let name = self.instance.library.class(class).name;
        name.name.as_str() == NAME && self.instance.library.sources.get(name.span.file).path == FILE
    }

    fn class_of_unit(&mut self, found: &ClassRef<'a>, args: &[Modifier<'a>], declared: Span) -> Option<ClassRef<'a>> {
        let Some((file, at)) = self.text_given(args, "file")? else {
            let d = Diagnostic::new(Code::NoValue, "a component of class `FMU` needs the file of its unit");
            self.instance
                .report(d.at(declared, "declared here").help("name it: `FMU controller(file = \"controller.fmu\")`"));
            return None;
        };
        let kind = self.text_given(args, "kind")?.map_or_else(|| "auto".to_owned(), |(kind, _)| kind);
        let class = self.opened(&file, &kind, at)?.class;
        Some(ClassRef { class, ..found.clone() })
    }

    /// The value that modifications give to a text; inner `None` where they give none.
    fn text_given(&mut self, args: &[Modifier<'a>], name: &str) -> Option<Option<(String, Span)>> {
        let value = |arg: &Modifier<'a>| match arg.kind {
            ModifierKind::Modify([target], Some(m)) if target.name.as_str() == name => {
                Some((m.value.as_ref()?, arg.view))
            }
            _ => None,
        };
        let Some((expr, view)): Option<(&'a Expr, _)> = args.iter().find_map(value) else { return Some(None) };
        let value = self.instance.evaluator().constant(expr, view)?;
        match value.as_text(&self.instance.exprs) {
            Some(text) => Some(Some((text, expr.span))),
            None => self.instance.evaluator().wrong_type("a text that is known before the run", &value, expr.span),
        }
    }

    /// A unit by the name of its file and its kind, read and loaded at its first use.
    pub(in crate::instance) fn opened(&mut self, file: &str, kind: &str, at: Span) -> Option<&FmuClass> {
        let key = (file.to_owned(), kind.to_owned());
        if !self.instance.functions.units.contains_key(&key) {
            let bytes = match self.instance.library.bytes(file) {
                Ok(bytes) => bytes,
                Err(why) => {
                    let d = Diagnostic::new(Code::FileAccess, format!("cannot read `{file}`: {why}"));
                    let help =
                        "a relative path begins at the folder of the model's file, or else where the command runs";
                    self.instance.report(d.at(at, "the unit is named here").help(help));
                    return None;
                }
            };
            let unit = match ImportedFmu::open(bytes, kind) {
                Ok(unit) => Arc::new(unit),
                Err(why) => {
                    let d = Diagnostic::new(Code::BadMockUp, format!("the unit `{file}` cannot be used: {why}"));
                    self.instance.report(d.at(at, "the unit is named here"));
                    return None;
                }
            };
            let class = self.instance.library.generated(file, &unit.class())?;
            self.instance.functions.units.insert(key.clone(), FmuClass { unit, class });
        }
        self.instance.functions.units.get(&key)
    }

    /// The object behind the equations of a component: its unit with the values of its texts.
    pub(in crate::instance) fn mock_up(
        &mut self,
        given: &[ExternalValue],
        place: FileReference,
    ) -> Option<ModelicaValue> {
        let [ExternalValue::Text(file), ExternalValue::Text(kind), ExternalValue::Text(texts)] = given else {
            return self.instance.fail(Code::NotConstant, "texts of a unit must be known before the run", place.call);
        };
        let unit = self.opened(file, kind, place.call)?.unit.clone();
        Some(ModelicaValue::Object(ExternalObject::MockUp(Arc::new(unit.pool(texts)))))
    }
}
