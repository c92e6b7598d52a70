//! Standard output, and notes beside it.

use std::io::{self, ErrorKind, Write};

use serde::Serialize;

use super::error::CliError;

/// Writes `text` and a line end. A reader who has gone away is no error.
pub fn line(text: &str) -> Result<(), CliError> {
    let mut out = io::stdout().lock();
    match writeln!(out, "{text}").and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(CliError::failed(format!(
            "standard output cannot be written: {error}"
        ))),
        _ => Ok(()),
    }
}

/// Writes a line for the person at the terminal, formatted as by `format!`. A reader who has gone
/// away, or a full disk behind it, must not cost the picture.
macro_rules! note {
    ($($text:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stderr().lock(), $($text)*);
    }};
}
pub(crate) use note;

/// Writes one JSON value.
pub fn json(value: &impl Serialize) -> Result<(), CliError> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|error| CliError::failed(format!("the result is no JSON: {error}")))?;
    line(&text)
}

/// A number with four significant digits.
pub fn figure(x: f64) -> String {
    if x == 0.0 || (1e-3..1e5).contains(&x.abs()) {
        let digits = 3 - x.abs().max(1e-3).log10().floor() as i32;
        format!("{x:.*}", digits.clamp(0, 6) as usize)
    } else {
        format!("{x:.3e}")
    }
}

/// Bytes in the unit that suits them.
pub fn bytes(n: usize) -> String {
    const UNITS: [&str; 4] = ["B", "KiB", "MiB", "GiB"];
    let (mut x, mut unit) = (n as f64, 0);
    while x >= 1024.0 && unit + 1 < UNITS.len() {
        x /= 1024.0;
        unit += 1;
    }
    if unit == 0 {
        format!("{n} B")
    } else {
        format!("{x:.1} {}", UNITS[unit])
    }
}

/// Seconds as a person reads them.
pub fn duration(seconds: f64) -> String {
    let s = seconds.max(0.0).round() as u64;
    match s {
        0..60 => format!("{s} s"),
        60..3600 => format!("{} min {:02} s", s / 60, s % 60),
        _ => format!("{} h {:02} min", s / 3600, s / 60 % 60),
    }
}

/// Text that HTML shows as it is.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_keep_four_digits() {
        assert_eq!(figure(0.0), "0.000000");
        assert_eq!(figure(1.0), "1.000");
        assert_eq!(figure(0.012_345), "0.01235");
        assert_eq!(figure(1234.56), "1235");
        assert_eq!(figure(-2.5e-7), "-2.500e-7");
        assert_eq!(figure(1.25e9), "1.250e9");
    }

    #[test]
    fn units_suit_their_numbers() {
        assert_eq!(
            (bytes(12), bytes(1536)),
            ("12 B".to_owned(), "1.5 KiB".to_owned())
        );
        assert_eq!(duration(59.4), "59 s");
        assert_eq!(duration(61.0), "1 min 01 s");
        assert_eq!(duration(7265.0), "2 h 01 min");
    }
}
