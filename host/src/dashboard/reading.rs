//! How the photo on the desk is read: tags, the camera, and places where nothing is an obstacle.

use super::error::Failure;
use crate::cli::args::{TagPointName, VisionArgs};
use clap::ValueEnum;
use serde::{Deserialize, Serialize};
use wmr::shape::Circle;
use wmr::vision::Camera;

/// More ignored places than this are no reading of a photo.
const MOST_IGNORED: usize = 200;

/// The options of `wmr detect`, as a page gives and gets them.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Reading {
    /// `outer`, `centre` or `inner`: tags stand in the arena's corners.
    tags: Option<String>,
    robot_tag: Option<usize>,
    goal_tag: Option<usize>,
    /// Discs in which nothing is an obstacle: x, y and radius, metres.
    ignore: Vec<[f64; 3]>,
    /// A camera file's document.
    camera: Option<CameraFile>,
}

#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
struct CameraFile {
    main: Camera,
}

impl Reading {
    /// Checks what a page has sent.
    pub(super) fn check(&self) -> Result<(), Failure> {
        named::<TagPointName>(&self.tags)?;
        if self.ignore.len() > MOST_IGNORED {
            return Err(Failure::bad_request(format!("more than {MOST_IGNORED} ignored places")));
        }
        let is_disc =
            |disc: &&[f64; 3]| disc.iter().all(|value| value.is_finite()) && disc[2] > 0.0;
        if let Some(bad) = self.ignore.iter().find(|disc| !is_disc(disc)) {
            return Err(Failure::bad_request(format!("{bad:?} is no disc: x, y and a radius")));
        }
        Ok(())
    }

    /// The same as the options of `wmr detect`.
    pub(super) fn vision_args(&self) -> Result<VisionArgs, Failure> {
        let disc =
            |&[x, y, radius]: &[f64; 3]| Circle { centre: wmr::geometry::Point { x, y }, radius };
        Ok(VisionArgs {
            tags: named(&self.tags)?,
            robot_tag: self.robot_tag,
            goal_tag: self.goal_tag,
            ignore: self.ignore.iter().map(disc).collect(),
            ..VisionArgs::default()
        })
    }

    pub(super) fn camera(&self) -> Option<Camera> {
        self.camera.as_ref().map(|file| file.main.clone())
    }
}

/// A choice by the name that the command line knows it by.
pub(super) fn named<T: ValueEnum>(name: &Option<String>) -> Result<Option<T>, Failure> {
    let Some(name) = name else { return Ok(None) };
    T::from_str(name, false).map(Some).map_err(|_| {
        let all: Vec<_> =
            T::value_variants().iter().filter_map(ValueEnum::to_possible_value).collect();
        let known: Vec<_> = all.iter().map(|value| value.get_name()).collect();
        Failure::bad_request(format!("{name:?} is not one of {}", known.join(", ")))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reading(text: &str) -> Result<Reading, String> {
        let reading: Reading = serde_json::from_str(text).map_err(|error| error.to_string())?;
        reading.check().map_err(|failure| failure.error.message)?;
        Ok(reading)
    }

    #[test]
    fn options_are_those_of_the_command_line() {
        let text = r#"{"tags":"inner","robot_tag":7,"ignore":[[0.1,0.2,0.05]]}"#;
        let args = reading(text).unwrap().vision_args().unwrap();
        assert_eq!((args.tags, args.robot_tag), (Some(TagPointName::Inner), Some(7)));
        assert_eq!(args.ignore[0].radius, 0.05);
    }

    #[test]
    fn what_is_no_reading_is_refused() {
        for text in [
            r#"{"tags":"corner"}"#,
            r#"{"robot_tag":-1}"#,
            r#"{"ignore":[[0,0,0]]}"#,
            r#"{"ignore":[[0,0]]}"#,
            r#"{"camera":{"main":{"model":"none"}}}"#,
            r#"{"tag":1}"#,
        ] {
            assert!(reading(text).is_err(), "{text}");
        }
    }
}
