//! Waveforms as viewers show them: every variable in the group of its scope, with a radix.

use crate::{Radix, Variable, Waveform};

/// Zoom in GTKWave is the binary logarithm of the time on 200 pixels, below 0; its first window has room for so many of those.
const FRAMES: f64 = 2.25;
/// Rows of a curve in GTKWave, beside its own.
const CURVE_ROWS: usize = 2;

/// Flags of a row in GTKWave's `analyzer.h`.
const HEXADECIMAL: u32 = 1 << 1;
const DECIMAL: u32 = 1 << 2;
const BINARY: u32 = 1 << 3;
const RIGHT: u32 = 1 << 5;
const BLANK: u32 = 1 << 9;
const SIGNED: u32 = 1 << 10;
const ASCII: u32 = 1 << 11;
const STEPS: u32 = 1 << 15;
const CURVE_ROW: u32 = 1 << 17;
const FULL_SCALE: u32 = 1 << 19;
const GROUP_BEGIN: u32 = 1 << 23;
const GROUP_END: u32 = 1 << 24;
/// The widest number that GTKWave shows as one.
const NUMBER_BITS: u32 = 64;

impl Variable {
    /// The scopes and the name.
    fn parts(&self) -> (&[String], &str) {
        self.path.split_last().map_or((&[], ""), |(name, scopes)| (scopes, name.as_str()))
    }

    fn gtkwave_flags(&self) -> u32 {
        let shown = match self.radix {
            _ if self.bits == 1 => BINARY,
            Radix::Text => ASCII,
            _ if self.bits > NUMBER_BITS => HEXADECIMAL,
            Radix::Hexadecimal => HEXADECIMAL,
            Radix::Unsigned => DECIMAL,
            Radix::Signed => SIGNED,
            Radix::Level => DECIMAL | STEPS | FULL_SCALE,
        };
        shown | RIGHT
    }

    /// The format, for more than one bit.
    fn surfer_format(&self) -> Option<&'static str> {
        (self.bits > 1).then_some(match self.radix {
            Radix::Hexadecimal => "Hexadecimal",
            Radix::Unsigned | Radix::Level => "Unsigned",
            Radix::Signed => "Signed",
            Radix::Text => "ASCII",
        })
    }
}

/// An item's number in letters, a to p for the hexadecimal digits, as Surfer's commands take it.
fn letters(item: usize) -> String {
    format!("{item:x}")
        .bytes()
        .map(|digit| char::from(b'a' + (digit as char).to_digit(16).unwrap_or(0) as u8))
        .collect()
}

impl Waveform {
    /// Runs of variables of the same scope, with the scope's name.
    fn groups(&self) -> impl Iterator<Item = (&str, &[Variable])> {
        let groups = self.variables.chunk_by(|a, b| a.parts().0 == b.parts().0);
        groups.map(|group| (group[0].parts().0.last().map_or("", String::as_str), group))
    }

    /// A save file of GTKWave: `name` with `.gtkw` behind it, for this waveform in the same folder as `name` with `.fst`.
    pub fn gtkwave(&self, name: &str) -> String {
        // GTKWave counts in whole steps of a thousand.
        let units = (self.end - self.start) as f64 * 10_f64.powi(i32::from(self.timescale_exponent).rem_euclid(3));
        let zoom = -(units / FRAMES).log2();
        // With both names GTKWave finds the waveform where the save file is, not where it was started.
        let mut text = format!("[dumpfile] \"{name}.fst\"\n[savefile] \"{name}.gtkw\"\n[timestart] {}\n", self.start);
        text += &format!("*{zoom:.6} -1{}\n", " -1".repeat(26));
        let mut last = None;
        // Flags hold until the next.
        let mut line = |flags: u32, name: &str| {
            if last.replace(flags) != Some(flags) {
                text += &format!("@{flags:x}\n");
            }
            text += &format!("{name}\n");
        };
        for (name, group) in self.groups() {
            line(GROUP_BEGIN | BLANK, &format!("-{name}"));
            for variable in group {
                let range = if variable.bits > 1 { format!("[{}:0]", variable.bits - 1) } else { String::new() };
                line(variable.gtkwave_flags(), &format!("{}{range}", variable.path.join(".")));
                if variable.gtkwave_flags() & STEPS != 0 {
                    (0..CURVE_ROWS).for_each(|_| line(CURVE_ROW, "-"));
                }
            }
            line(GROUP_END | BLANK, &format!("-{name}"));
        }
        text
    }

    /// A command file of Surfer for this waveform.
    pub fn surfer(&self) -> String {
        let (mut items, mut formats) = (String::new(), String::new());
        let mut count = 0;
        for (name, group) in self.groups() {
            items += &format!("divider_add {name}\n");
            count += 1;
            for variable in group {
                let path = variable.path.join(".");
                items += &format!("variable_add {path}\n");
                if let Some(format) = variable.surfer_format() {
                    formats += &format!("item_focus {}_{path}\nitem_set_format {format}\n", letters(count));
                    if variable.radix == Radix::Level {
                        formats += "item_set_analog step\n";
                    }
                }
                count += 1;
            }
        }
        items + &formats + "item_unfocus\nzoom_fit\n"
    }
}
