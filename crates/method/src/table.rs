//! The table, and its rows.

use crate::{RenderError, Subject, machine, twin};
use cube3_picture::{Rendering, Watch};
use cube3_rendering::{About, MethodError, SceneMethod, Settings};
use cube3_scene::Scene;

/// Makes a picture of a subject.
pub type RenderMachine = fn(&Subject<'_>, &Settings, Watch<'_>) -> Result<Rendering, RenderError>;

/// How a method makes a picture.
#[derive(Clone, Copy, Debug)]
pub enum Render {
    /// From scene and volume alone.
    Scene(&'static SceneMethod),
    /// On a machine, or along its rays.
    Machine(RenderMachine),
}

/// A row: a way to make a picture.
#[derive(Clone, Copy, Debug)]
pub struct Method {
    /// What is said of it.
    pub about: &'static About,
    /// How it makes a picture.
    pub render: Render,
}

impl Method {
    /// A row for a method that needs scene and volume alone.
    pub const fn of_scene(method: &'static SceneMethod) -> Method {
        Method { about: &method.about, render: Render::Scene(method) }
    }

    /// A row for a method on a machine, or along its rays.
    pub const fn of_machine(about: &'static About, render: RenderMachine) -> Method {
        Method { about, render: Render::Machine(render) }
    }

    /// Whether scene and volume are all that it needs.
    pub fn needs_no_machine(&self) -> bool {
        matches!(self.render, Render::Scene(_))
    }

    /// Refuses a scene that asks for what the method cannot show.
    ///
    /// # Errors
    /// What it lacks by name, and the methods that can show the scene.
    pub fn check(&self, scene: &Scene) -> Result<(), MethodError> {
        let lacks = self.about.lacks(scene);
        if lacks.is_empty() {
            return Ok(());
        }
        let able = METHODS.iter().filter(|method| method.about.lacks(scene).is_empty());
        let able = able.map(|method| method.about.name).collect();
        Err(MethodError::Lacks { method: self.about.name, lacks, able })
    }

    /// Makes the picture of a subject; `watch` is told how far each phase is.
    ///
    /// # Errors
    /// A scene that asks for what the method cannot show, and what the method itself refuses.
    pub fn render(
        &self,
        subject: &Subject<'_>,
        settings: &Settings,
        watch: Watch<'_>,
    ) -> Result<Rendering, RenderError> {
        self.check(subject.scene)?;
        match self.render {
            Render::Scene(method) => Ok((method.render)(&subject.as_scene(), settings, watch)?),
            Render::Machine(render) => render(subject, settings, watch),
        }
    }
}

/// Every way to make a picture.
pub static METHODS: &[&Method] = &[&FUNCTION, &CYCLE, &SHEARED, &TRUE, &IMAGE_ORDER, &CONVERGED];

/// The machine without its clock.
pub static FUNCTION: Method = Method::of_machine(&machine::FUNCTION, machine::function);
/// The machine cycle by cycle.
pub static CYCLE: Method = Method::of_machine(&machine::CYCLE, machine::cycle);
/// The machine's rays and cells in reals.
pub static SHEARED: Method = Method::of_machine(&twin::SHEARED, twin::sheared);
/// The machine's rays in reals, and exact interpolation.
pub static TRUE: Method = Method::of_machine(&twin::TRUE, twin::true_3d);
/// Rays from pixels.
pub static IMAGE_ORDER: Method = Method::of_scene(&cube3_reference::IMAGE_ORDER);
/// The ray integral itself.
pub static CONVERGED: Method = Method::of_scene(&cube3_converged::CONVERGED);

/// The names of a table's methods.
pub fn names(table: &[&Method]) -> Vec<&'static str> {
    table.iter().map(|method| method.about.name).collect()
}

/// The method of that name in a table.
///
/// # Errors
/// No such method; the message has the nearest name and all of them.
pub fn find(table: &[&'static Method], name: &str) -> Result<&'static Method, MethodError> {
    table
        .iter()
        .copied()
        .find(|method| method.about.name == name)
        .ok_or_else(|| MethodError::unknown(name, &names(table)))
}
