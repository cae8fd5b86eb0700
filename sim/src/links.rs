//! What boards cost beside the beams on the bus: longer ways between neighbouring lanes, and their words.

use cube3_abc::reach;
use cube3_cone::ConeSpec;
use cube3_dsb::BoardSpec;
use cube3_host::{ChannelSize, Channels, FrameSetup, MachineSpec};
use serde::{Deserialize, Serialize};

/// Words that a ray sends over the links, all links and both directions together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RayWords {
    /// TRILIN: voxels of the next depth and edges of the ray before, each of two planes.
    pub trilin: u64,
    /// ABC: samples of the lanes that the gradient reads on the other side.
    pub abc: u64,
    /// Cone: nodes between boards.
    pub cone: u64,
}

impl RayWords {
    /// The words of a ray in a frame.
    pub fn new(machine: &MachineSpec, setup: &FrameSetup) -> RayWords {
        let boards = BoardSpec::new(machine).boards;
        if boards == 1 {
            return RayWords::default();
        }
        // A lane of each side of each link, for each chunk of the ray.
        let lanes = (2 * boards * setup.geometry.size[2].div_ceil(machine.lanes)) as u64;
        let reach = setup.gradient.map_or(0, |gradient| reach(gradient.method, setup.most_reach()));
        RayWords { trilin: 2 * lanes, abc: reach as u64 * lanes, cone: ConeSpec::new(machine, setup).link_words() }
    }

    /// The words of so many rays.
    pub fn times(self, rays: u64) -> RayWords {
        RayWords { trilin: self.trilin * rays, abc: self.abc * rays, cone: self.cone * rays }
    }

    /// The sum.
    pub fn plus(self, other: RayWords) -> RayWords {
        RayWords { trilin: self.trilin + other.trilin, abc: self.abc + other.abc, cone: self.cone + other.cone }
    }
}

/// The channels with what boards and the kind of cone add: a beam may go to the farthest board, samples to the lanes beside; room for
/// the tokens on their way comes with it.
pub fn channels(machine: &MachineSpec) -> Channels {
    let spec = BoardSpec::new(machine);
    let farther = |size: ChannelSize, hops: usize| {
        let more = hops as u64 * spec.latency;
        ChannelSize { capacity: size.capacity + more as usize, latency: size.latency + more }
    };
    let sizes = machine.channel;
    Channels {
        aligned: farther(sizes.aligned, spec.diameter()),
        samples: farther(sizes.samples, spec.neighbour_hops(1)),
        shaded: farther(sizes.shaded, spec.neighbour_hops(reach(machine.abc.gradient, 1))),
        pixels: ConeSpec::pixels(machine),
        ..sizes
    }
}
