//! Options of a method, as rows, and what was chosen.

use crate::MethodError;

/// What values an option has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OptionKind {
    /// A number within a closed range.
    Number {
        /// Least and largest.
        range: [f64; 2],
        /// Where nothing is given.
        default: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// One of some words, the first where nothing is given.
    Word(&'static [&'static str]),
}

/// An option of a method. On the command line it stands behind a colon, as its value alone: `image-order:0.25`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MethodOption {
    /// Its name.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// Its values.
    pub kind: OptionKind,
}

impl MethodOption {
    /// The value that stands for nothing given: of a word its place.
    pub fn default(&self) -> f64 {
        match self.kind {
            OptionKind::Number { default, .. } => default,
            OptionKind::Word(_) => 0.0,
        }
    }

    /// The value of a text, where it is one of this option.
    fn parse(&self, text: &str) -> Option<f64> {
        match self.kind {
            OptionKind::Number { range: [least, largest], .. } => {
                text.parse().ok().filter(|value| (least..=largest).contains(value))
            }
            OptionKind::Word(words) => words.iter().position(|word| *word == text).map(|place| place as f64),
        }
    }

    /// The text of a value.
    fn text(&self, value: f64) -> String {
        match self.kind {
            OptionKind::Number { .. } => shown(value),
            OptionKind::Word(words) => words.get(value as usize).copied().unwrap_or_default().to_owned(),
        }
    }

    /// Its values in words.
    pub fn values(&self) -> String {
        match self.kind {
            OptionKind::Number { range: [least, largest], default, unit } => {
                format!("{} to {} {unit}, {} without it", shown(least), shown(largest), shown(default))
            }
            OptionKind::Word(words) => format!("{}, {} without it", words.join(" or "), words[0]),
        }
    }
}

/// A number as it can be given; small ones by their exponent.
fn shown(value: f64) -> String {
    if value != 0.0 && value.abs() < 1e-3 { format!("{value:e}") } else { value.to_string() }
}

/// A value for each option of a method, in the order of its rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings(Vec<f64>);

impl Settings {
    /// Those of no options given.
    pub fn defaults(options: &[MethodOption]) -> Settings {
        Settings(options.iter().map(MethodOption::default).collect())
    }

    /// Those of the texts behind a method's name, each between colons: each is a value of an option that it fits.
    ///
    /// # Errors
    /// A text that is no value of any option.
    pub fn parse(method: &'static str, options: &[MethodOption], texts: &str) -> Result<Settings, MethodError> {
        let mut settings = Settings::defaults(options);
        for text in texts.split(':') {
            let fits = options.iter().enumerate().find_map(|(place, option)| Some((place, option.parse(text)?)));
            let Some((place, value)) = fits else {
                let known =
                    options.iter().map(|option| format!("{}: {}", option.name, option.values())).collect::<Vec<_>>();
                return Err(MethodError::Option { method, text: text.to_owned(), known: known.join("; ") });
            };
            settings.0[place] = value;
        }
        Ok(settings)
    }

    /// The value of the option at a place among the rows; a word's is its place.
    pub fn value(&self, place: usize) -> f64 {
        self.0[place]
    }

    /// With another value of the option at a place.
    #[must_use]
    pub fn with(mut self, place: usize, value: f64) -> Settings {
        self.0[place] = value;
        self
    }

    /// What stands behind a method's name for these: a colon and the value of each option that is not as without it.
    pub fn text(&self, options: &[MethodOption]) -> String {
        let given = options.iter().zip(&self.0).filter(|(option, value)| option.default() != **value);
        given.map(|(option, &value)| format!(":{}", option.text(value))).collect()
    }
}
