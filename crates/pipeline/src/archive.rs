//! The state of a machine, for checkpoints: all that a run changes.

use crate::Fidelity;
use crate::machine::Machine;
use cube3_channel::{Archive, ArchiveError, Archived};

impl<F: Fidelity> Archived for Machine<F> {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        let Machine {
            frames: _,
            schedules: _,
            slots: _,
            overlap: _,
            ray_words: _,
            traffic,
            cfb,
            bus,
            dsb,
            trilin,
            abc,
            cone,
            host,
            beams,
            aligned,
            rays,
            samples,
            shaded,
            pixels,
            cycle,
            last_move,
            frame_ends,
        } = self;
        cfb.archive(archive)?;
        bus.archive(archive)?;
        dsb.archive(archive)?;
        trilin.archive(archive)?;
        abc.archive(archive)?;
        cone.archive(archive)?;
        host.archive(archive)?;
        if let Some(traffic) = traffic {
            traffic.archive(archive)?;
        }
        beams.archive(archive)?;
        aligned.archive(archive)?;
        rays.archive(archive)?;
        samples.archive(archive)?;
        shaded.archive(archive)?;
        pixels.archive(archive)?;
        archive.item(cycle)?;
        archive.item(last_move)?;
        archive.item(frame_ends)
    }
}
