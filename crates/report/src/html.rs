//! The report as one page for a browser.

use maud::{DOCTYPE, Markup, PreEscaped, html};
use serde_json::Value;

use crate::bars::bars;
use crate::drawing::drawing;
use crate::fact::listed;
use crate::facts::{self, CycleKind};
use crate::glossary::glossary;
use crate::headline::headline;
use crate::pictures::{Figure, pictures, sequence};
use crate::quantity::{count, number, prefixed};
use crate::shares::percent;
use crate::{
    ChannelReport, DigestReport, ErrorReport, LimitsReport, OperatorsReport, PlanReport, ResourcesReport, RunReport,
    TimingReport, TrafficReport, UnitReport,
};

const STYLE: &str = include_str!("page.css");

/// The page may show what it carries, and reach for nothing else.
const POLICY: &str = "default-src 'none'; img-src data:; style-src 'unsafe-inline'";

/// The report as one HTML page that holds its pictures and needs no network.
///
/// All text from the report is escaped, so a scene's name can say `<script>` and mean it.
pub fn html(report: &RunReport, figures: &[Figure]) -> String {
    let subject = facts::subject(report);
    let name = &report.program.name;
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (name) ": " (subject) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                header {
                    h1 { (subject) }
                    (headline(report))
                    (listed(&facts::asked(report)))
                    p.note {
                        "New to the machine? It is " a href="#machine" { "drawn below" } ", and the words are in the "
                        a href="#glossary" { "glossary" } "."
                    }
                }
                main {
                    (pictures(figures))
                    (sequence(report.sequence.as_ref()))
                    (drawing(&report.units, &report.channels))
                    (limits(report.limits.as_ref()))
                    (units(&report.units, report.timing.as_ref()))
                    (errors(report.error.as_ref()))
                    (timing(report.timing.as_ref()))
                    (plan(&report.plan))
                    (channels(&report.channels))
                    (traffic(report.traffic.as_ref()))
                    (resources(report.resources.as_ref()))
                    (overflows(report))
                    section { h2 { "Set-up" } (listed(&facts::derived(report))) }
                    (wall(report))
                    (digests(&report.digest))
                    (glossary())
                    (source("The scene as resolved", &report.scene))
                    (source("The machine as resolved", &report.machine))
                }
            }
        }
    };
    page.into_string()
}

fn units(units: &[UnitReport], timing: Option<&TimingReport>) -> Markup {
    html! {
        @if !units.is_empty() {
            section {
                h2 { "What each unit did with its cycles" }
                (bars(units))
                div.wide {
                    table {
                        @if let Some(timing) = timing {
                            caption { "Each row adds up to the " (count(timing.cycles)) " cycles of the run" }
                        }
                        thead {
                            tr {
                                th scope="col" { "Unit" }
                                @for kind in ["Busy", "Starved", "Blocked", "Waiting for"] {
                                    th.number scope="col" { (kind) }
                                }
                            }
                        }
                        tbody { @for unit in units { (unit_row(unit)) } }
                    }
                }
            }
        }
    }
}

fn unit_row(unit: &UnitReport) -> Markup {
    let shares = facts::cycle_shares(unit);
    let (waiting, working): (Vec<_>, Vec<_>) = shares.into_iter().partition(|share| share.kind == CycleKind::Waiting);
    html! {
        tr {
            th scope="row" { (unit.name) }
            @for share in working {
                td.number { (count(share.cycles)) " " span.share { (percent(share.thousandths)) } }
            }
            td.number {
                @if unit.waiting_cycles() == 0 { "nothing" }
                @for share in waiting.iter().filter(|share| share.cycles > 0) {
                    div { (share.name) " " (count(share.cycles)) " " span.share { (percent(share.thousandths)) } }
                }
            }
        }
    }
}

fn errors(error: Option<&ErrorReport>) -> Markup {
    html! {
        section {
            h2 { "Error" }
            @if let Some(remark) = error.and_then(|error| error.remark.as_ref()) {
                p { "Not measured: " (remark) "." }
            } @else if let Some(error) = error {
                div.wide { table {
                    caption {
                        "Against " (error.against) ". The object covers " (count(error.footprint.pixels as u64))
                        " pixels. The difference picture is magnified " (number(error.difference_factor)) " times."
                    }
                    thead {
                        tr {
                            th scope="col" { "Measure" }
                            th.number scope="col" { "Whole image" }
                            th.number scope="col" { "Object alone" }
                        }
                    }
                    tbody {
                        @for (what, [whole, object]) in facts::errors(error) {
                            tr { th scope="row" { (what) } td.number { (whole) } td.number { (object) } }
                        }
                    }
                } }
            } @else {
                p { "Not measured: there was no reference to compare with." }
            }
        }
    }
}

fn timing(timing: Option<&TimingReport>) -> Markup {
    html! {
        section {
            h2 { "Throughput at the machine's clock" }
            @if let Some(timing) = timing {
                (listed(&facts::timing(timing)))
            } @else {
                p { "Not measured: no clock ran." }
            }
        }
    }
}

fn plan(plan: &PlanReport) -> Markup {
    html! {
        section {
            h2 { "Left out" }
            @if !plan.enabled {
                p { "Nothing: the plan was switched off." }
            } @else if plan.left_out.is_empty() {
                p { "Nothing: this scene needs all of the machine." }
            } @else {
                div.wide {
                    table {
                        caption { "What cannot change the picture was neither built nor run. The picture is the same with it, bit for bit." }
                        thead { tr { th scope="col" { "What" } th scope="col" { "Why" } th scope="col" { "Saves" } } }
                        tbody {
                            @for item in &plan.left_out {
                                tr { th scope="row" { (item.what) } td { (item.why) } td { (item.saves) } }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn channels(channels: &[ChannelReport]) -> Markup {
    let columns = ["Capacity", "Latency", "Pushes", "Pops", "Left in it", "Most at once", "Mean"];
    html! {
        @if !channels.is_empty() {
            section {
                h2 { "Channels" }
                div.wide {
                    table {
                        caption { "In tokens; latency in cycles" }
                        thead {
                            tr {
                                th scope="col" { "Channel" }
                                @for column in columns { th.number scope="col" { (column) } }
                            }
                        }
                        tbody { @for channel in channels { (channel_row(channel)) } }
                    }
                }
            }
        }
    }
}

fn channel_row(channel: &ChannelReport) -> Markup {
    let counts =
        [channel.capacity, channel.latency, channel.pushes, channel.pops, channel.occupancy, channel.max_occupancy];
    html! {
        tr {
            th scope="row" { (channel.name) }
            @for value in counts { td.number { (count(value)) } }
            td.number { (number(channel.mean_occupancy)) }
        }
    }
}

fn limits(limits: Option<&LimitsReport>) -> Markup {
    html! {
        @if let Some(limits) = limits {
            section {
                h2 { "What limits the frame rate" }
                p { (limits.sentence) }
                @if !limits.without.is_empty() {
                    div.wide {
                        table {
                            caption { "The machine with one resource out of the way; " (number(limits.fps)) " frames per second as it is" }
                            thead {
                                tr {
                                    th scope="col" { "Without" }
                                    th scope="col" { "Replaced by" }
                                    th.number scope="col" { "Frames per second" }
                                }
                            }
                            tbody {
                                @for without in &limits.without {
                                    tr {
                                        th scope="row" { (without.resource) }
                                        td { (without.replaced_by) }
                                        td.number { (number(without.fps)) }
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn traffic(traffic: Option<&TrafficReport>) -> Markup {
    html! {
        @if let Some(traffic) = traffic {
            section { h2 { "Traffic" } (listed(&facts::traffic(traffic))) }
        }
    }
}

fn resources(resources: Option<&ResourcesReport>) -> Markup {
    let Some(resources) = resources else { return html! {} };
    html! {
        section {
            h2 { "What the machine is made of" }
            (listed(&facts::resources(resources)))
            div.wide {
                table {
                    caption { "Operators" }
                    thead {
                        tr {
                            th scope="col" { "Part" }
                            @for column in ["How often", "Multipliers", "Adders", "Comparators", "Dividers"] {
                                th.number scope="col" { (column) }
                            }
                        }
                    }
                    tbody {
                        @for part in &resources.operators { (operators_row(part)) }
                    }
                }
            }
            div.wide {
                table {
                    caption { "Memory and lines" }
                    thead {
                        tr { th scope="col" { "What" } th scope="col" { "Counted" } th.number scope="col" { "Bits" } }
                    }
                    tbody {
                        @for memory in &resources.memory {
                            tr { th scope="row" { (memory.what) } td { (memory.counted) } td.number { (count(memory.bits)) } }
                        }
                        @for lines in &resources.lines {
                            tr { th scope="row" { (lines.what) } td { (lines.counted) } td.number { (count(lines.lines)) } }
                        }
                    }
                }
            }
            div.wide {
                table {
                    caption { "Interfaces" }
                    thead {
                        tr { th scope="col" { "Interface" } th.number scope="col" { "Peak" } th.number scope="col" { "Mean" } }
                    }
                    tbody {
                        @for interface in &resources.interfaces {
                            tr {
                                th scope="row" { (interface.name) }
                                td.number {
                                    @match interface.peak_bytes_per_s {
                                        Some(peak) => (prefixed(peak, "B/s")),
                                        None => "no limit",
                                    }
                                }
                                td.number { (prefixed(interface.mean_bytes_per_s, "B/s")) }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn operators_row(part: &OperatorsReport) -> Markup {
    let counts = part.each.times(part.count);
    html! {
        tr {
            th scope="row" { (part.part) }
            @for value in [part.count, counts.multipliers, counts.adders, counts.comparators, counts.dividers] {
                td.number { (count(value)) }
            }
        }
    }
}

fn overflows(report: &RunReport) -> Markup {
    let overflows = || report.words.overflows.iter().filter(|(_, count)| **count > 0);
    html! {
        section {
            h2 { "Words" }
            @if overflows().next().is_none() {
                p { "No result overflowed its word." }
            } @else {
                table {
                    caption { "Results that overflowed their word and were saturated" }
                    thead { tr { th scope="col" { "Wire" } th.number scope="col" { "Results" } } }
                    tbody {
                        @for (wire, value) in overflows() {
                            tr { th scope="row" { (wire) } td.number { (count(*value)) } }
                        }
                    }
                }
            }
        }
    }
}

fn wall(report: &RunReport) -> Markup {
    let facts = facts::wall(&report.wall);
    html! {
        @if !facts.is_empty() {
            section { h2 { "Wall time on this computer" } (listed(&facts)) }
        }
    }
}

fn digests(digest: &DigestReport) -> Markup {
    let digests = [("Base plane", &digest.base_plane), ("Image", &digest.image)];
    html! {
        @if digests.iter().any(|(_, digest)| digest.is_some()) {
            section {
                h2 { "SHA-256 of the raw pixels" }
                dl.facts {
                    @for (what, digest) in digests {
                        @if let Some(digest) = digest { div { dt { (what) } dd { code { (digest) } } } }
                    }
                }
            }
        }
    }
}

/// The value as TOML, ready for a file; as JSON where TOML cannot say it (a null, a bare value).
fn source(title: &str, value: &Value) -> Markup {
    let (language, text) = match toml::to_string(value) {
        Ok(text) => ("TOML", text),
        Err(_) => ("JSON", format!("{value:#}")),
    };
    html! {
        details {
            summary { (title) " (" (language) ")" }
            pre tabindex="0" { code { (text) } }
        }
    }
}
