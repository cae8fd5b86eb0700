//! The bounded channel, cycle by cycle.

use crate::{Device, Port, Sheet, Tables, Unit, UnitFormat, WireRecorder};
use cube3_channel::Channel as GoldenChannel;

/// The channel.
pub struct ChannelSheet;

impl Unit for ChannelSheet {
    fn sheet(&self) -> Sheet {
        Sheet {
            name: "channel",
            title: "Bounded channel",
            purpose: "A queue of CAPACITY tokens, each of which takes LATENCY cycles from push to pop. In a cycle one token is pushed and one \
                      popped at most. A token on its way counts towards the capacity, and the credit of a popped token comes back with the \
                      clock's edge: a full channel that is popped cannot be pushed in the same cycle, and a full rate needs a capacity of \
                      LATENCY + 1. A line is a cycle after reset; outputs are those before the edge that ends it. A push without `can_push` \
                      and a pop without `valid` are ignored.",
            source: "`cube3_channel::Channel`",
            parameters: &["capacity", "latency"],
            module: Some(("cube3_channel", ".WIDTH(16)")),
            inputs: vec![
                Port::unsigned("push", "1", "a token is pushed"),
                Port::unsigned("in_data", "16", "the token"),
                Port::unsigned("pop", "1", "the oldest token is popped"),
            ],
            tables: Vec::new(),
            wires: Vec::new(),
            outputs: vec![
                Port::unsigned("can_push", "1", "a credit is there"),
                Port::unsigned("valid", "1", "the oldest token has arrived"),
                Port::unsigned("front", "16", "the oldest token, 0 where it has not arrived"),
                Port::unsigned("occupancy", "8", "tokens held, those on their way included").within("0", "CAPACITY"),
            ],
            clocked: true,
        }
    }

    /// A cycle of an empty channel; what a channel answers depends on the cycles before: see [`Unit::start`].
    fn evaluate(&self, format: &UnitFormat, _: &Tables, inputs: &[i128], _: &mut WireRecorder) -> Vec<i128> {
        self.start(format).map_or_else(Vec::new, |mut device| device(inputs))
    }

    /// Bursts: full, empty, full rate, and each rate of one side against the other.
    fn corners(&self, format: &UnitFormat) -> Vec<Vec<i128>> {
        let burst = i128::from(format.capacity + format.latency + 2);
        let mut lines = Vec::new();
        let mut token = 1;
        for (pushes, pops) in [(1, 0), (0, 1), (1, 1), (1, 2), (2, 1), (1, 3), (3, 1), (0, 1)] {
            for cycle in 0..3 * burst {
                let on = |every: i128| i128::from(every > 0 && cycle % every == 0);
                lines.push(vec![on(pushes), token, on(pops)]);
                token = (token * 5 + 1) & 0xffff;
            }
        }
        lines
    }

    fn formats(&self) -> Vec<UnitFormat> {
        let sizes = [(1, 1), (1, 3), (2, 1), (3, 2), (4, 2), (4, 3), (8, 6), (18, 16)];
        sizes.map(|(capacity, latency)| UnitFormat { capacity, latency, ..UnitFormat::default() }).to_vec()
    }

    fn start<'a>(&'a self, format: &'a UnitFormat) -> Option<Device<'a>> {
        let mut channel =
            GoldenChannel::new("channel", format.capacity.max(1) as usize, u64::from(format.latency.max(1)));
        Some(Box::new(move |inputs| {
            let Ok(channel) = &mut channel else { return vec![0; 4] };
            let outputs = vec![
                channel.can_push().into(),
                channel.front().is_some().into(),
                channel.front().copied().unwrap_or(0),
                channel.occupancy() as i128,
            ];
            if inputs[2] == 1 {
                channel.pop();
            }
            if inputs[0] == 1 {
                // Without a credit the push is ignored.
                let _ = channel.push(inputs[1]);
            }
            channel.commit();
            outputs
        }))
    }
}
