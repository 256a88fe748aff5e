//! FMUs as components: `FMU unit(file = "controller.fmu")`.
//!
//! The file is opened when the component is built. A Modelica class is generated from its description and replaces the
//! class `FMU` of the component. During the run the equations of that class call the unit.

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

/// The class that stands for all FMUs.
const NAME: &str = "FMU";
/// The file in the shipped library that declares it.
const FILE: &str = "components/FMU.mo";

/// An FMU that was opened, with the class generated for it.
pub(in crate::instance) struct FmuClass {
    /// The opened unit.
    pub unit: Arc<ImportedFmu>,
    /// The generated class.
    class: ClassId,
}

impl<'a> ComponentBuilder<'_, 'a, '_> {
    /// The class of a component: the generated one for a component of class `FMU`, otherwise `found`.
    ///
    /// `args` are the modifiers of the component, from which the file is taken. `None` after a message.
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

    /// Whether a class is the shipped `FMU`, and not a user's class of that name.
    fn stands_for_units(&self, class: ClassId) -> bool {
        let name = self.instance.library.class(class).name;
        name.name.as_str() == NAME && self.instance.library.sources.get(name.span.file).path == FILE
    }

    /// The class generated for the unit that the modifiers name. `None` after a message.
    /// The modifier `kind` selects model exchange or co-simulation; the default is "auto".
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

    /// The String that the modifiers give to a parameter, with its place.
    ///
    /// `Some(None)` if no modifier gives it. `None` after a message, if it is not known or no String.
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

    /// The unit in a file, opened at its first use. `None` after a message.
    /// Two components with the same file and kind share the unit and its class.
    /// `kind` is "cs", "me" or "auto"; `at` is where the file is named.
    pub(in crate::instance) fn opened(&mut self, file: &str, kind: &str, at: Span) -> Option<&FmuClass> {
        let key = (file.to_owned(), kind.to_owned());
        // Opening loads the code of the unit, so it is done once.
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

    /// The external object behind the equations of a component. `None` after a message.
    /// `given` are the file, the kind, and the values of the unit's String parameters, all of which must be known.
    pub(in crate::instance) fn mock_up(
        &mut self,
        given: &[ExternalValue],
        place: FileReference,
    ) -> Option<ModelicaValue> {
        // All three must be known here, because Strings are not part of the run.
        let [ExternalValue::Text(file), ExternalValue::Text(kind), ExternalValue::Text(texts)] = given else {
            return self.instance.fail(Code::NotConstant, "texts of a unit must be known before the run", place.call);
        };
        let unit = self.opened(file, kind, place.call)?.unit.clone();
        Some(ModelicaValue::Object(ExternalObject::MockUp(Arc::new(unit.pool(texts)))))
    }
}
