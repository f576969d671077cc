//! What marks in a photo mean: tags in the arena's corners, on the robot and at the goal, and places where
//! nothing is an obstacle. Metres in the arena frame.

use super::camera::PlanMap;
use super::image::Photo;
use super::options::DetectOptions;
use super::tags::{self, Tag, TagDictionary, find_tags};
use super::warning::Warning;
use crate::shape::{Circle, Polygon, Shape};

/// The tags of a photo, by what they mark.
pub(super) struct Marks {
    pub(super) seen: Vec<Tag>,
    pub(super) robot: Option<Tag>,
    pub(super) goal: Option<Tag>,
}

impl Marks {
    /// Looks for tags if any are asked for.
    pub(super) fn of(photo: &Photo, options: &DetectOptions) -> Self {
        let (robot, goal) = (options.robot_tag, options.goal_tag);
        let is_asked = options.tags.is_some() || robot.is_some() || goal.is_some();
        let seen = if is_asked { find_tags(photo, &TagDictionary::usual()) } else { Vec::new() };
        let numbered = |id: Option<usize>| id.and_then(|id| seen.iter().find(|tag| tag.id == id));
        Self { robot: numbered(robot).cloned(), goal: numbered(goal).cloned(), seen }
    }

    /// The tags that mark neither robot nor goal.
    pub(super) fn corners(&self) -> Vec<&Tag> {
        let others = [&self.robot, &self.goal];
        let is_other = |tag: &Tag| others.iter().any(|other| other.as_ref() == Some(tag));
        self.seen.iter().filter(|tag| !is_other(tag)).collect()
    }

    /// The places on the floor that tags cover and those that a person leaves out: nothing there is an
    /// obstacle.
    pub(super) fn left_out(&self, map: &PlanMap, ignored: &[Circle]) -> Vec<Shape> {
        covered(self.seen.iter(), map, ignored)
    }

    /// The same without the robot's tag.
    pub(super) fn left_out_at_rest(&self, map: &PlanMap, ignored: &[Circle]) -> Vec<Shape> {
        covered(self.seen.iter().filter(|tag| Some(*tag) != self.robot.as_ref()), map, ignored)
    }

    /// What to say of tags that were asked for and are not seen.
    pub(super) fn missing(&self, options: &DetectOptions) -> Vec<Warning> {
        let wanted =
            [("robot", options.robot_tag, &self.robot), ("goal", options.goal_tag, &self.goal)];
        let lost = wanted.into_iter().filter(|(_, _, found)| found.is_none());
        lost.filter_map(|(of, id, _)| Some(Warning::TagNotSeen { of, id: id? })).collect()
    }
}

/// The places on the floor that tags cover and those that are ignored.
fn covered<'a>(
    tags: impl Iterator<Item = &'a Tag>,
    map: &PlanMap,
    ignored: &[Circle],
) -> Vec<Shape> {
    // A tag whose outline is none on the floor is seen edge on, and stands on no floor.
    let tags = tags.filter_map(|tag| Polygon::new(tags::patch(tag, map)).ok());
    tags.map(Shape::from).chain(ignored.iter().map(|&disc| disc.into())).collect()
}
