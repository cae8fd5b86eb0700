//! What a report says in words: what, and its value.

use maud::{Markup, html};

/// What is said, and its value.
pub(crate) type Fact = (&'static str, String);

/// Facts as a list.
pub(crate) fn listed(facts: &[Fact]) -> Markup {
    html! {
        dl.facts { @for (what, value) in facts { div { dt { (what) } dd { (value) } } } }
    }
}
