//! A method with its options, as it stands on a command line.

use crate::{METHODS, Method, RenderError, Subject, find};
use cube3_picture::{Rendering, Watch};
use cube3_rendering::{MethodError, Settings};
use std::fmt;
use std::str::FromStr;

/// A method with a value for each of its options. Its text is the method's name, and behind colons what was chosen: `image-order:0.25`.
#[derive(Clone, Debug)]
pub struct Choice {
    /// The method.
    pub method: &'static Method,
    /// A value for each of its options.
    pub settings: Settings,
}

impl Choice {
    /// A method without options given.
    pub fn of(method: &'static Method) -> Choice {
        Choice { method, settings: Settings::defaults(method.about.options) }
    }

    /// Of a table, the method that a text names, with the options behind the colons.
    ///
    /// # Errors
    /// A name that is not in the table, a text that is no value of any of the method's options.
    pub fn parse(table: &[&'static Method], text: &str) -> Result<Choice, MethodError> {
        let (name, given) = text.split_once(':').map_or((text, None), |(name, given)| (name, Some(given)));
        let method = find(table, name)?;
        let about = method.about;
        let settings = match given {
            Some(given) => Settings::parse(about.name, about.options, given)?,
            None => Settings::defaults(about.options),
        };
        Ok(Choice { method, settings })
    }

    /// Makes the picture of a subject.
    ///
    /// # Errors
    /// As [`Method::render`].
    pub fn render(&self, subject: &Subject<'_>, watch: Watch<'_>) -> Result<Rendering, RenderError> {
        self.method.render(subject, &self.settings, watch)
    }
}

impl FromStr for Choice {
    type Err = MethodError;

    fn from_str(text: &str) -> Result<Choice, MethodError> {
        Choice::parse(METHODS, text)
    }
}

impl PartialEq for Choice {
    fn eq(&self, other: &Choice) -> bool {
        self.method.about.name == other.method.about.name && self.settings == other.settings
    }
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.method.about.name, self.settings.text(self.method.about.options))
    }
}
