//! What pixels depend on, and which parts a frame gets.

use crate::{Rule, Rules};
use cube3_machine::{MachineSpec, ShadingUnit};
use cube3_scene::{Mode, Scene};

/// What the pixels of a scene depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Needs {
    /// Lit colours.
    pub light: bool,
    /// Gradients.
    pub gradient: bool,
    /// Lengths or directions of gradients.
    pub normal: bool,
    /// A depth cue.
    pub depth_cue: bool,
}

impl Needs {
    /// Those of a scene on a machine, whose shading unit may read the gradient as it is.
    pub fn of(scene: &Scene, machine: &MachineSpec) -> Needs {
        let light = scene.material.shaded && lights_matter(scene.mode);
        let rows = scene.transfer.is_two_dimensional();
        Needs {
            light,
            gradient: light || rows,
            normal: rows || (light && machine.abc.shading == ShadingUnit::Phong),
            depth_cue: scene.depth_cue.is_some(),
        }
    }
}

/// Modes whose pixel is a lit colour; the others show values.
fn lights_matter(mode: Mode) -> bool {
    matches!(mode, Mode::Composite | Mode::FirstOpaque | Mode::LastOpaque)
}

/// How a frame has a part of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Presence {
    /// Pixels depend on it.
    Needed,
    /// It is there, on registers that change nothing.
    Idle,
    /// It is not there.
    Absent,
}

impl Presence {
    /// Whether it is there.
    pub fn is_there(self) -> bool {
        self != Presence::Absent
    }

    fn new(needed: bool, idle: bool) -> Presence {
        match (needed, idle) {
            (true, _) => Presence::Needed,
            (false, true) => Presence::Idle,
            (false, false) => Presence::Absent,
        }
    }
}

/// Which parts a frame gets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    /// The rules that it follows.
    pub rules: Rules,
    /// What pixels depend on.
    pub needs: Needs,
    /// The gradient unit.
    pub gradient: Presence,
    /// The normaliser, which reads the gradient.
    pub normaliser: Presence,
    /// The shading unit, which reads normals.
    pub shading: Presence,
    /// Depth cueing.
    pub depth_cue: Presence,
}

impl Plan {
    /// The plan for a scene on a machine that follows these rules. A part that is kept brings those that it reads.
    pub fn new(scene: &Scene, machine: &MachineSpec, rules: Rules) -> Plan {
        let needs = Needs::of(scene, machine);
        let keep = |rule| !rules.follow(rule);
        let shading = Presence::new(needs.light, keep(Rule::ShadingUnit));
        let normaliser = Presence::new(needs.normal, keep(Rule::Normaliser) || shading == Presence::Idle);
        let gradient = Presence::new(needs.gradient, keep(Rule::GradientUnit) || normaliser == Presence::Idle);
        let depth_cue = Presence::new(needs.depth_cue, keep(Rule::DepthCue));
        Plan { rules, needs, gradient, normaliser, shading, depth_cue }
    }
}
