//! A calibrated camera, as in OpenCV: it gives the map from floor to photo without looking for a border.
//!
//! `Xc = R Xw + t`, perspective n = (Xc/Zc, Yc/Zc) or orthographic n = (Xc, Yc), `d = n (1 + k1 |n|²)`,
//! `u = K00 d_x + K02`, `v = K11 d_y + K12`; metres in the arena frame, z up, pixels in the photo.

use super::floor_map::PlanMap;
use super::pose::Viewpoint;
use crate::geometry::Point;
use crate::vision::error::VisionError;
use crate::vision::image::Photo;
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// How rays reach the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum CameraModel {
    /// Through one point, as in any real camera.
    Perspective,
    /// In parallel, as from very far; K00 is pixels per metre.
    Orthographic,
}

/// A camera at a known pose over the arena.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Camera {
    /// How rays reach the picture.
    pub model: CameraModel,
    /// Width and height of the picture, pixels.
    pub image_size: [usize; 2],
    /// The camera matrix.
    #[serde(rename = "K")]
    pub matrix: [[f64; 3]; 3],
    /// The radial coefficient.
    pub k1: f64,
    /// The rotation from the arena frame to the camera's, rows first.
    #[serde(rename = "R")]
    pub rotation: [[f64; 3]; 3],
    /// The translation of the same, metres.
    #[serde(rename = "t")]
    pub translation: [f64; 3],
    /// How sure these numbers are, if that is known; else they are taken for exact.
    #[serde(rename = "sd", default, skip_serializing_if = "Option::is_none")]
    pub spread: Option<CameraSpread>,
}

/// How far the foot point of a calibrated camera may be off if it does not say so, metres.
const CALIBRATED: f64 = 0.02;

/// The standard deviations of a camera's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct CameraSpread {
    /// Of the focal length, pixels.
    pub focal: f64,
    /// Of the principal point's x and y, pixels.
    pub principal_point: [f64; 2],
    /// Of the radial coefficient.
    pub k1: f64,
    /// Of the lens's place in the arena frame, metres.
    pub position: [f64; 3],
}

/// A height that is less sure than this share of it is no better than what a picture shows of the robot.
const SURE_HEIGHT: f64 = 0.03;

impl Camera {
    /// The map from floor to photo that this camera makes.
    ///
    /// # Errors
    /// [`VisionError::Camera`] if the photo has another size, pixels are not square, or the floor is
    /// seen edge-on.
    pub fn plan_map(&self, photo: &Photo) -> Result<PlanMap, VisionError> {
        let refuse = |reason: String| VisionError::Camera { reason };
        let [width, height] = self.image_size;
        if (width, height) != (photo.width(), photo.height()) {
            return Err(refuse(format!(
                "it is for {width} x {height} pixels, the photo has {} x {}",
                photo.width(),
                photo.height()
            )));
        }
        let [[focal, _, x], [_, focal_y, y], _] = self.matrix;
        if focal.is_nan() || focal <= 0.0 || (focal_y / focal - 1.0).abs() > 1e-3 {
            return Err(refuse(format!(
                "K00 is {focal} and K11 {focal_y}; they must be positive and equal"
            )));
        }
        let rays = self.rays();
        let to_ideal = Matrix3::new(focal, 0.0, x, 0.0, focal, y, 0.0, 0.0, 1.0) * rays;
        PlanMap::with_lens(to_ideal, [x, y], focal, self.k1)
            .ok_or_else(|| refuse("it sees the floor edge-on".into()))
    }

    /// The camera's foot point and height; `None` for an orthographic one, to which nothing leans.
    pub(crate) fn viewpoint(&self) -> Option<Viewpoint> {
        let centre = -(self.turn().transpose() * Vector3::from(self.translation));
        let perspective = self.model == CameraModel::Perspective;
        let foot = Point::new(centre.x, centre.y);
        let spread = self.spread.map_or(CALIBRATED, |of| of.position[0].hypot(of.position[1]));
        let knows_height =
            self.spread.is_none_or(|spread| spread.position[2] < SURE_HEIGHT * centre.z);
        perspective.then_some(Viewpoint { foot, height: centre.z, spread, knows_height })
    }

    /// Whether the camera's height is known, not just guessed from the border.
    pub(crate) fn knows_height(&self) -> bool {
        self.viewpoint().is_none_or(|view| view.knows_height)
    }

    fn turn(&self) -> Matrix3<f64> {
        Matrix3::from_row_iterator(self.rotation.into_iter().flatten())
    }

    /// Takes floor points (x, y, 1) to rays n.
    fn rays(&self) -> Matrix3<f64> {
        let (turn, shift) = (self.turn(), Vector3::from(self.translation));
        let rays = Matrix3::from_columns(&[
            turn.column(0).into_owned(),
            turn.column(1).into_owned(),
            shift,
        ]);
        match self.model {
            CameraModel::Perspective => rays,
            CameraModel::Orthographic => Matrix3::from_rows(&[
                rays.row(0).into_owned(),
                rays.row(1).into_owned(),
                nalgebra::RowVector3::new(0.0, 0.0, 1.0),
            ]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn overhead(model: CameraModel, focal: f64) -> Camera {
        Camera {
            model,
            image_size: [640, 480],
            matrix: [[focal, 0.0, 319.5], [0.0, focal, 239.5], [0.0, 0.0, 1.0]],
            k1: 0.0,
            rotation: [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
            translation: [-1.0, 0.5, 2.0],
            spread: None,
        }
    }

    #[test]
    fn a_point_beside_the_foot_lies_beside_the_centre() {
        let photo = Photo::from_rgb(640, 480, vec![[0; 3]; 640 * 480]).unwrap();
        let camera = overhead(CameraModel::Perspective, 600.0);
        let view = camera.viewpoint().unwrap();
        assert_eq!((view.foot, view.height), (Point::new(1.0, 0.5), 2.0));
        let [x, y] = camera.plan_map(&photo).unwrap().to_photo(Point::new(1.2, 0.6));
        assert!((x - (319.5 + 60.0)).abs() < 1e-9 && (y - (239.5 - 30.0)).abs() < 1e-9);
        let flat = overhead(CameraModel::Orthographic, 200.0);
        let [x, _] = flat.plan_map(&photo).unwrap().to_photo(Point::new(1.2, 0.6));
        assert!((x - (319.5 + 40.0)).abs() < 1e-9 && flat.viewpoint().is_none());
    }

    #[test]
    fn a_height_is_known_unless_it_is_said_to_be_unsure() {
        let sure = overhead(CameraModel::Perspective, 600.0);
        let spread = |height: f64| {
            Some(CameraSpread {
                focal: 1.0,
                principal_point: [6.0; 2],
                k1: 0.01,
                position: [0.0, 0.0, height],
            })
        };
        assert!(sure.knows_height());
        assert!(Camera { spread: spread(0.01), ..sure.clone() }.knows_height());
        assert!(!Camera { spread: spread(0.5), ..sure }.knows_height());
    }

    #[test]
    fn a_camera_for_another_picture_is_refused() {
        let photo = Photo::from_rgb(64, 64, vec![[0; 3]; 4096]).unwrap();
        assert!(matches!(
            overhead(CameraModel::Perspective, 600.0).plan_map(&photo),
            Err(VisionError::Camera { .. })
        ));
    }
}
