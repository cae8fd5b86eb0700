//! The tokens in a machine's channels, by who they are.

use crate::Fidelity;
use crate::machine::{CHANNELS, Machine};
use crate::token::Token;
use cube3_abc::ShadedRay;
use cube3_cfb::Beam;
use cube3_channel::{Channel, ChannelCounters};
use cube3_cone::PixelGroup;
use cube3_dsb::RayPair;
use cube3_frame::Schedule;
use cube3_trilin::SampleRay;

/// The identity of a channel's token, of frames of these schedules.
trait Identified {
    fn token(&self, schedules: &[Schedule]) -> Token;
}

impl<D> Identified for Beam<D> {
    fn token(&self, schedules: &[Schedule]) -> Token {
        // Pieces of a beam come with their sections.
        let number = |schedule: &Schedule| schedule.plane_number(self.section, self.plane) as u32;
        let plane = schedules.get(self.frame as usize).map_or(self.plane, number);
        Token { frame: self.frame, plane, place: self.depth }
    }
}

macro_rules! ray_identity {
    ($($token:ident),*) => {
        $(impl<D> Identified for $token<D> {
            fn token(&self, _: &[Schedule]) -> Token {
                Token { frame: self.frame, plane: self.plane, place: self.slot }
            }
        })*
    };
}

ray_identity!(RayPair, SampleRay, ShadedRay, PixelGroup);

/// What a function says of each channel and the schedules, in the order of [`Machine::JOINTS`]. The channels are of six types.
macro_rules! of_channels {
    ($machine:expr, $of:ident) => {{
        let Machine { schedules, beams, aligned, rays, samples, shaded, pixels, .. } = $machine;
        [
            $of(beams, schedules),
            $of(aligned, schedules),
            $of(rays, schedules),
            $of(samples, schedules),
            $of(shaded, schedules),
            $of(pixels, schedules),
        ]
    }};
}

impl<F: Fidelity> Machine<F> {
    /// What each channel has counted, and the token that it was given last, where it holds it, with the cycles that its words on links
    /// make it later; in the order of [`Machine::JOINTS`].
    #[inline]
    pub fn newest(&self) -> [(ChannelCounters, Option<(Token, u64)>); CHANNELS] {
        #[inline]
        fn of<T: Identified>(channel: &Channel<T>, schedules: &[Schedule]) -> (ChannelCounters, Option<(Token, u64)>) {
            (channel.counters(), channel.newest().map(|token| (token.token(schedules), channel.newest_late())))
        }
        of_channels!(self, of)
    }

    /// The tokens in each channel, oldest first, each with the cycles until it can be popped.
    pub fn held(&self) -> [Vec<(Token, u64)>; CHANNELS] {
        fn of<T: Identified>(channel: &Channel<T>, schedules: &[Schedule]) -> Vec<(Token, u64)> {
            channel.held().map(|(token, cycles)| (token.token(schedules), cycles)).collect()
        }
        of_channels!(self, of)
    }
}
