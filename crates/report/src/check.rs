//! What must hold in every report.

use cube3_machine::OperatorCounts;
use cube3_metrics::ImageError;

use crate::error::finite;
use crate::{
    ChannelReport, ErrorReport, OpacityReport, ReportError, ResourcesReport, RunReport, SCHEMA, SequenceReport,
    TimingReport, TrafficReport, UnitReport, measures,
};

/// How far two ways to compute one number may differ, relative to it.
const ROUNDING: f64 = 1e-9;

impl RunReport {
    /// Checks that every cycle of every unit is accounted for, that no channel lost or invented a
    /// token, that times and rates follow from the cycles, and that every number is finite.
    ///
    /// # Errors
    ///
    /// The first of these that does not hold, with the place and the numbers.
    pub fn check(&self) -> Result<(), ReportError> {
        if self.schema != SCHEMA {
            return Err(ReportError::Schema { found: self.schema.into(), expected: SCHEMA });
        }
        self.check_finite()?;
        match &self.timing {
            Some(timing) => {
                timing.check()?;
                self.units.iter().try_for_each(|unit| unit.check(timing.cycles))?;
            }
            None if self.units.is_empty() => {}
            None => return Err(ReportError::UnitsWithoutTiming { units: self.units.len() }),
        }
        if let Some(resources) = &self.resources {
            resources.check()?;
        }
        if let Some(traffic) = &self.traffic {
            traffic.check()?;
        }
        self.channels.iter().try_for_each(ChannelReport::check)?;
        self.error.as_ref().map_or(Ok(()), ErrorReport::check)?;
        self.sequence.as_ref().map_or(Ok(()), |sequence| sequence.check(self))
    }

    /// Checks that every number is finite.
    pub(crate) fn check_finite(&self) -> Result<(), ReportError> {
        let finite = |key: &str, value: f64| finite(key, value);
        for value in self.volume.spacing {
            finite("volume.spacing", value)?;
        }
        for value in self.volume.window {
            finite("volume.window", value)?;
        }
        finite("volume.scale", self.volume.scale.unwrap_or(0.0))?;
        if let Some(axes) = &self.volume.axes {
            finite("volume.axes.turned_deg", axes.turned_deg)?;
            finite("volume.axes.slanted_deg", axes.slanted_deg)?;
        }
        for value in self.view.slopes {
            finite("view.slopes", value)?;
        }
        finite("view.offset", self.view.offset)?;
        for value in self.view.perspective.iter().flat_map(|perspective| perspective.eye_voxel) {
            finite("view.perspective.eye_voxel", value)?;
        }
        if let Some(timing) = &self.timing {
            finite("timing.clock_hz", timing.clock_hz)?;
            finite("timing.frame_time_s", timing.frame_time_s)?;
            finite("timing.fps", timing.fps)?;
            finite("timing.fps_sustained", timing.fps_sustained)?;
            finite("timing.samples_per_s", timing.samples_per_s)?;
        }
        if let Some(limits) = &self.limits {
            finite("limits.fps", limits.fps)?;
            finite("limits.fps_without", limits.fps_without.unwrap_or(0.0))?;
            limits.without.iter().try_for_each(|without| finite("limits.without.fps", without.fps))?;
        }
        if let Some(resources) = &self.resources {
            finite("resources.fps_per_memory_gb_per_s", resources.fps_per_memory_gb_per_s)?;
            finite("resources.samples_per_s_per_multiplier", resources.samples_per_s_per_multiplier)?;
            for interface in &resources.interfaces {
                finite("resources.interfaces.mean_bytes_per_s", interface.mean_bytes_per_s)?;
                finite("resources.interfaces.peak_bytes_per_s", interface.peak_bytes_per_s.unwrap_or(0.0))?;
            }
        }
        for channel in &self.channels {
            finite(&format!("channels.{}.mean_occupancy", channel.name), channel.mean_occupancy)?;
        }
        if let Some(error) = &self.error {
            error.whole.iter().try_for_each(|whole| finite_error("error", whole))?;
            error.footprint.error.iter().try_for_each(|object| finite_error("error.footprint", object))?;
            if let Some(own) = &error.reference {
                finite_error("error.reference", &own.error)?;
            }
            finite("error.gradient_mean_deg", error.gradient_mean_deg.unwrap_or(0.0))?;
            finite("error.difference_factor", error.difference_factor)?;
        }
        self.words.opacity.iter().try_for_each(OpacityReport::check)?;
        for (key, value) in self.sequence.iter().flat_map(|sequence| sequence.numbers()) {
            finite(key, value)?;
        }
        let wall = &self.wall;
        for (key, value) in [
            ("wall.volume_s", wall.volume_s),
            ("wall.timing_s", wall.timing_s),
            ("wall.function_s", wall.function_s),
            ("wall.cycle_s", wall.cycle_s),
            ("wall.reference_s", wall.reference_s),
            ("wall.total_s", wall.total_s),
            ("wall.samples_per_s", wall.samples_per_s),
        ] {
            finite(key, value.unwrap_or(0.0))?;
        }
        Ok(())
    }
}

impl TimingReport {
    fn check(&self) -> Result<(), ReportError> {
        let derived = Self::from(self.counts());
        for (key, found, expected) in [
            ("timing.frame_time_s", self.frame_time_s, derived.frame_time_s),
            ("timing.fps", self.fps, derived.fps),
            ("timing.fps_sustained", self.fps_sustained, derived.fps_sustained),
            ("timing.samples_per_s", self.samples_per_s, derived.samples_per_s),
        ] {
            if (found - expected).abs() > ROUNDING * expected.abs() {
                return Err(ReportError::Inconsistent { key, found, expected });
            }
        }
        Ok(())
    }
}

impl ResourcesReport {
    /// The sum is that of the parts, and nothing carries more than it can.
    fn check(&self) -> Result<(), ReportError> {
        let sum: OperatorCounts = self.operators.iter().map(|part| part.each.times(part.count)).sum();
        if sum != self.total {
            let (found, expected) = (self.total.multipliers as f64, sum.multipliers as f64);
            return Err(ReportError::Inconsistent { key: "resources.total", found, expected });
        }
        for interface in &self.interfaces {
            let mean = interface.mean_bytes_per_s;
            if let Some(peak) = interface.peak_bytes_per_s.filter(|peak| mean > peak * (1.0 + ROUNDING)) {
                return Err(ReportError::Inconsistent { key: "resources.interfaces", found: mean, expected: peak });
            }
        }
        Ok(())
    }
}

impl TrafficReport {
    /// Each command found its row open, closed, or another one; the reorder buffer held no more than it can, and has been given every word
    /// that was read; bus and links carried no more than they can, and links what units sent.
    fn check(&self) -> Result<(), ReportError> {
        let inconsistent = |key, found: u64, expected: u64| {
            Err(ReportError::Inconsistent { key, found: found as f64, expected: expected as f64 })
        };
        if let Some(memory) = &self.memory {
            let rows = memory.row_hits + memory.row_misses + memory.row_conflicts;
            if rows != memory.reads {
                return inconsistent("traffic.memory", rows, memory.reads);
            }
        }
        if let (Some(buffer), Some(memory)) = (&self.reorder, &self.memory) {
            if buffer.peak_words > buffer.words {
                return inconsistent("traffic.reorder.peak_words", buffer.peak_words, buffer.words);
            }
            if memory.words > 8 * buffer.mini_blocks {
                return inconsistent("traffic.memory.words", memory.words, 8 * buffer.mini_blocks);
            }
        }
        if self.bus_words > self.bus_slots {
            return inconsistent("traffic.bus_words", self.bus_words, self.bus_slots);
        }
        for link in &self.links {
            if let Some(slots) = link.slots.filter(|&slots| link.words > slots) {
                return inconsistent("traffic.links.words", link.words, slots);
            }
        }
        let carried: u64 = self.links.iter().map(|link| link.words).sum();
        let sent = self.link_words + self.ray_words.iter().sum::<u64>();
        if !self.links.is_empty() && carried != sent {
            return inconsistent("traffic.links", carried, sent);
        }
        Ok(())
    }
}

impl ErrorReport {
    /// No mean and no percentile of distances is beyond the largest, and no bias beyond the mean.
    fn check(&self) -> Result<(), ReportError> {
        let own = self.reference.as_ref().map(|own| &own.error);
        for error in self.whole.iter().chain(&self.footprint.error).chain(own) {
            for (key, found, expected) in [
                ("error.mean_relative", error.mean_relative, error.max),
                ("error.percentile_99", error.percentile_99, error.max),
                ("error.bias", error.bias.abs(), error.mean_relative),
            ] {
                if found > expected * (1.0 + ROUNDING) {
                    return Err(ReportError::Inconsistent { key, found, expected });
                }
            }
        }
        Ok(())
    }
}

impl UnitReport {
    /// Cycles of waiting, whatever the reason.
    pub(crate) fn waiting_cycles(&self) -> u128 {
        self.waiting.values().map(|&cycles| u128::from(cycles)).sum()
    }

    fn check(&self, cycles: u64) -> Result<(), ReportError> {
        let working = [self.busy, self.starved, self.blocked].map(u128::from);
        let accounted = working.iter().sum::<u128>() + self.waiting_cycles();
        if accounted != u128::from(cycles) {
            return Err(ReportError::UnitCycles { unit: self.name.clone(), accounted, cycles });
        }
        Ok(())
    }
}

impl ChannelReport {
    fn check(&self) -> Result<(), ReportError> {
        let &Self { capacity, pushes, pops, occupancy, max_occupancy: max, .. } = self;
        let mean = self.mean_occupancy;
        if pops.checked_add(occupancy) != Some(pushes) {
            let channel = self.name.clone();
            return Err(ReportError::ChannelTokens { channel, pushes, pops, occupancy });
        }
        let mean_fits = (0.0..=max as f64 * (1.0 + ROUNDING)).contains(&mean);
        if occupancy > max || max > capacity || !mean_fits {
            let channel = self.name.clone();
            return Err(ReportError::ChannelOccupancy { channel, capacity, occupancy, max, mean });
        }
        Ok(())
    }
}

impl SequenceReport {
    /// What holds in every sequence: frames follow each other without gap, shares are shares, and what is torn shows two volumes.
    pub(crate) fn check(&self, report: &RunReport) -> Result<(), ReportError> {
        let same = |key, found: f64, expected: f64| {
            if found == expected { Ok(()) } else { Err(ReportError::Inconsistent { key, found, expected }) }
        };
        if let Some(timing) = &report.timing {
            same("timing.frames", timing.frames as f64, self.frames.len() as f64)?;
            let mut end = 0;
            for frame in &self.frames {
                end += frame.cycles.unwrap_or_default();
                same("sequence.frames[].end_cycle", frame.end_cycle.unwrap_or_default() as f64, end as f64)?;
            }
            same("timing.cycles", timing.cycles as f64, end as f64)?;
        }
        for frame in &self.frames {
            same("sequence.frames[].torn", frame.torn.into(), (frame.newest_volume > frame.volume).into())?;
            same("sequence.frames[].newer_fraction", frame.torn.into(), (frame.newer_fraction > 0.0).into())?;
        }
        let torn = self.frames.iter().filter(|frame| frame.torn).count();
        let expected = self.acquisition.as_ref().map_or(0, |acquisition| acquisition.torn_frames);
        same("sequence.acquisition.torn_frames", torn as f64, expected as f64)
    }
}

fn finite_error(key: &str, error: &ImageError) -> Result<(), ReportError> {
    measures::finite(error).into_iter().try_for_each(|(measure, value)| finite(&format!("{key}.{measure}"), value))
}
