//! The drawing of the machine is of the units and channels that the report names.

use crate::sample;
use cube3_report::html;

/// The drawing on the page.
fn drawing(page: &str) -> &str {
    let from = page.find("<svg class=\"machine\"").expect("no drawing");
    let length = page[from..].find("</svg>").unwrap();
    &page[from..from + length]
}

#[test]
fn each_unit_is_a_box_and_each_channel_an_arrow_with_its_name() {
    let report = sample::report();
    let page = html(&report, &[]);
    let drawing = drawing(&page);
    assert_eq!(drawing.matches("<rect class=\"unit\"").count(), report.units.len());
    // Two ports of one unit are joined by dashes.
    assert_eq!(drawing.matches("<line class=\"channel\"").count(), report.channels.len() + 1);
    assert_eq!(drawing.matches("stroke-dasharray").count(), 1);
    for name in report.units.iter().map(|unit| &unit.name).chain(report.channels.iter().map(|channel| &channel.name)) {
        assert!(drawing.contains(&format!(">{name}<")), "{name}");
    }
}

#[test]
fn a_unit_that_nobody_explains_is_drawn_with_its_name() {
    let mut report = sample::report();
    report.units[2].name = "prefilter".into();
    let page = html(&report, &[]);
    assert!(drawing(&page).contains(">prefilter<"));
    assert_eq!(drawing(&page).matches("<line class=\"channel\"").count(), 2, "no arrow to where no channel goes");
}

#[test]
fn no_text_leaves_the_drawing() {
    let mut report = sample::report();
    report.channels[0].mean_occupancy = 123_456.7;
    report.channels[0].capacity = 1_000_000;
    let page = html(&report, &[]);
    // Wide letters of the page's font at 14 px are about 8 px wide on the average.
    for line in drawing(&page).split("<text").skip(1) {
        let text: String = line
            .split("</text>")
            .next()
            .unwrap()
            .split('<')
            .filter_map(|piece| piece.split_once('>'))
            .map(|(_, text)| text)
            .collect();
        assert!(text.chars().count() <= 47, "{text}");
    }
}

#[test]
fn without_a_clock_there_is_nothing_to_draw_and_the_page_says_so() {
    let mut report = sample::report();
    (report.timing, report.limits, report.resources, report.traffic) = (None, None, None, None);
    report.units.clear();
    report.channels.clear();
    let page = html(&report, &[]);
    assert!(!page.contains("<svg class=\"machine\"") && page.contains("No clock ran"));
}

#[test]
fn words_of_the_page_are_in_a_glossary() {
    let page = html(&sample::report(), &[]);
    let glossary = page.split("<section id=\"glossary\">").nth(1).expect("no glossary");
    for word in ["voxel", "beam", "base plane", "level", "99th percentile", "bias", "cycle", "lane"] {
        assert!(glossary.contains(&format!("<dt>{word}</dt>")), "{word}");
    }
    assert!(page.contains("href=\"#glossary\"") && page.contains("href=\"#machine\""));
}
