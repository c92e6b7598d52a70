//! Frames of a sequence, a picture each.

use std::path::PathBuf;

use super::picture_of;
use crate::cli::args::RenderArgs;
use crate::cli::error::CliError;
use crate::cli::print::note;
use crate::cli::scene;

/// Stands in the output's name for the number of the frame.
const PLACE: char = '#';

/// Renders the frames `frames` in order.
pub fn run(args: &RenderArgs, frames: &str) -> Result<(), CliError> {
    let Some(count) = scene::read(&args.scene)?.frames else {
        return Err(CliError::usage(format!(
            "{} is a still, so it has no --frames; a sequence says how many frames it has",
            args.scene
        )));
    };
    let (first, last) = range(frames, count)?;
    let name = args.output.to_string_lossy().into_owned();
    let places = name.matches(PLACE).count();
    if places == 0 && first != last {
        return Err(CliError::usage(format!(
            "{name} is one file for many frames; write # where their number is to stand, such as \
             smoke-##.png"
        )));
    }
    if args.log.is_some() || args.reference.is_some() || args.json {
        return Err(CliError::usage(
            "--log, --reference and --json go with one picture, not with --frames",
        ));
    }
    let cancel = super::cancel_on_interrupt()?;
    for frame in first..=last {
        if cancel.check().is_err() {
            return Err(CliError::failed(format!("stopped before frame {frame}")));
        }
        note!("frame {frame} of {first} to {last}");
        let mut one = args.clone();
        one.output = numbered(&name, places, frame);
        picture_of(&one, frame, &cancel)?;
    }
    Ok(())
}

/// The first and the last frame of `all`, `A` or `A-B`.
fn range(text: &str, count: u32) -> Result<(u32, u32), CliError> {
    if text == "all" {
        return Ok((0, count - 1));
    }
    let (first, last) = text.split_once('-').unwrap_or((text, text));
    match (first.trim().parse(), last.trim().parse()) {
        (Ok(first), Ok(last)) if first <= last && last < count => Ok((first, last)),
        _ => Err(CliError::usage(format!(
            "--frames {text} is to be all, one frame or A-B within 0-{}",
            count - 1
        ))),
    }
}

/// The name with the number in its places: as many digits as places, or more.
fn numbered(name: &str, places: usize, frame: u32) -> PathBuf {
    let Some(start) = name.find(PLACE) else {
        return PathBuf::from(name);
    };
    let number = format!("{frame:0places$}");
    let rest: String = name[start..].chars().filter(|c| *c != PLACE).collect();
    PathBuf::from(format!("{}{number}{rest}", &name[..start]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_numbered() {
        assert_eq!(numbered("a-###.png", 3, 7), PathBuf::from("a-007.png"));
        assert_eq!(numbered("a#.exr", 1, 123), PathBuf::from("a123.exr"));
        assert_eq!(numbered("a.exr", 0, 1), PathBuf::from("a.exr"));
        let of = |text: &str| range(text, 48).ok();
        assert_eq!(of("all"), Some((0, 47)));
        assert_eq!(of("3"), Some((3, 3)));
        assert_eq!(of("3-9"), Some((3, 9)));
        for wrong in ["", "9-3", "0-48", "x", "1-2-3", "-1"] {
            assert_eq!(of(wrong), None, "{wrong}");
        }
    }
}
