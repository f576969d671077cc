//! The pinhole camera with its lens: where a point of the arena is in the picture, and what a pixel looks at.
//!
//! The model is OpenCV's with one radial term. Metres in the arena frame, z up; pixels, the centre of the
//! top left one at (0, 0), y down.
//!
//! | symbol | meaning |
//! |---|---|
//! | Xw, Xc | a point in the arena's and in the camera's frame, Xc = R Xw + t |
//! | n | the undistorted ray (Xc/Zc, Yc/Zc) |
//! | d | what the lens makes of it, d = n (1 + k1 n²) |
//! | u, v | the pixel, u = K00 dx + K02, v = K11 dy + K12 |

/// Newton's steps from distorted to undistorted rays; each doubles the digits, and lenses of rooms start close.
const NEWTON_STEPS: usize = 6;
/// The share of the picture that a camera's first view leaves around the floor, on each side.
const ROOM_AROUND: f64 = 0.08;

/// A vector in space.
pub(super) type Space = [f64; 3];

/// A camera's lens and where it is; the fields of a camera file.
#[derive(Clone, Debug, PartialEq)]
pub struct Lens {
    /// Width and height of the picture, pixels.
    pub image_size: [usize; 2],
    /// The camera matrix K, pixels.
    pub matrix: [[f64; 3]; 3],
    /// The radial coefficient.
    pub k1: f64,
    /// The rotation R from the arena's frame to the camera's, rows first.
    pub rotation: [[f64; 3]; 3],
    /// The translation t of the same, m.
    pub translation: [f64; 3],
}

/// What a pixel looks at: from the lens so many metres aside for each metre down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ray {
    pub(super) from: Space,
    pub(super) slope: [f64; 2],
}

impl Ray {
    /// Where it is at height `z`, m.
    pub(super) fn at(&self, z: f64) -> [f64; 2] {
        let down = self.from[2] - z;
        [self.from[0] + down * self.slope[0], self.from[1] + down * self.slope[1]]
    }
}

impl Lens {
    /// A camera without distortion, `height` above the middle of a floor of this size, m; the floor
    /// fills its picture but for a little room around.
    ///
    /// ```
    /// use wmr_sim::camera::Lens;
    /// let lens = Lens::above([2.0, 1.5], 2.5, [641, 481]);
    /// let [u, v] = lens.project([1.0, 0.75, 0.0]).unwrap();
    /// assert!((u - 320.0).abs() < 1e-9 && (v - 240.0).abs() < 1e-9);
    /// ```
    pub fn above([width, depth]: [f64; 2], height: f64, image_size: [usize; 2]) -> Self {
        let [columns, rows] = image_size.map(|pixels| pixels as f64);
        let share = 1.0 - 2.0 * ROOM_AROUND;
        let focal = share * height * (columns / width).min(rows / depth);
        let (x, y) = ((columns - 1.0) / 2.0, (rows - 1.0) / 2.0);
        Self {
            image_size,
            matrix: [[focal, 0.0, x], [0.0, focal, y], [0.0, 0.0, 1.0]],
            k1: 0.0,
            rotation: [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
            translation: [-width / 2.0, depth / 2.0, height],
        }
    }

    /// Where the lens is, m.
    pub fn position(&self) -> [f64; 3] {
        self.to_arena(self.translation).map(|part| -part)
    }

    /// The same camera shifted by `by`, m, in the arena, and turned by `turn`, rad, about its own x, y and z
    /// one after the other.
    pub fn moved(&self, by: [f64; 3], turn: [f64; 3]) -> Self {
        let mut rotation = self.rotation;
        for (axis, angle) in turn.into_iter().enumerate() {
            let (sin, cos) = angle.sin_cos();
            let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
            let (p, q) = (rotation[a], rotation[b]);
            rotation[a] = [0, 1, 2].map(|column| cos * p[column] - sin * q[column]);
            rotation[b] = [0, 1, 2].map(|column| sin * p[column] + cos * q[column]);
        }
        let position = self.position();
        let position = [0, 1, 2].map(|part| position[part] + by[part]);
        let translation = rotation.map(|row| -dot(row, position));
        Self { rotation, translation, ..self.clone() }
    }

    /// The pixel at which a point is seen; `None` behind the camera.
    pub fn project(&self, point: [f64; 3]) -> Option<[f64; 2]> {
        let seen = self.rotation.map(|row| dot(row, point));
        let [x, y, z] = [0, 1, 2].map(|part| seen[part] + self.translation[part]);
        if z <= 0.0 {
            return None;
        }
        let (x, y) = (x / z, y / z);
        let stretch = 1.0 + self.k1 * (x * x + y * y);
        let [[fx, _, cx], [_, fy, cy], _] = self.matrix;
        Some([fx * stretch * x + cx, fy * stretch * y + cy])
    }

    /// What a pixel looks at; `None` where that is not below the camera, or the lens shows nothing.
    pub(super) fn ray(&self, [u, v]: [f64; 2]) -> Option<Ray> {
        let [[fx, _, cx], [_, fy, cy], _] = self.matrix;
        let (dx, dy) = ((u - cx) / fx, (v - cy) / fy);
        let share = self.undistortion(dx.hypot(dy))?;
        let [x, y, z] = self.to_arena([share * dx, share * dy, 1.0]);
        (z < 0.0).then(|| Ray { from: self.position(), slope: [-x / z, -y / z] })
    }

    /// |n| / |d|, by Newton's method on |n| (1 + k1 |n|²) = |d|.
    fn undistortion(&self, distorted: f64) -> Option<f64> {
        if self.k1 == 0.0 || distorted == 0.0 {
            return Some(1.0);
        }
        let mut length = distorted;
        for _ in 0..NEWTON_STEPS {
            let slope = 1.0 + 3.0 * self.k1 * length * length;
            if slope <= 0.0 {
                return None;
            }
            length -= (length * (1.0 + self.k1 * length * length) - distorted) / slope;
        }
        Some(length / distorted)
    }

    /// The direction in the arena of one in the camera's frame: Rᵀ v.
    fn to_arena(&self, v: Space) -> Space {
        [0, 1, 2].map(|column| dot(self.rotation.map(|row| row[column]), v))
    }
}

fn dot(a: Space, b: Space) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tilted() -> Lens {
        let lens = Lens::above([2.0, 1.5], 2.5, [640, 480]);
        Lens { k1: -0.12, ..lens.moved([0.1, -0.3, 0.2], [0.15, -0.05, 0.3]) }
    }

    #[test]
    fn a_camera_straight_above_by_hand() {
        let lens = Lens::above([2.0, 1.5], 2.5, [640, 480]);
        // 0.84 of 640 pixels for 2 m of floor.
        let scale = 0.84 * 320.0;
        let [u, v] = lens.project([1.2, 1.0, 0.0]).unwrap();
        assert!((u - (319.5 + 0.2 * scale)).abs() < 1e-9);
        assert!((v - (239.5 - 0.25 * scale)).abs() < 1e-9);
        // What is half way up to the lens seems twice as far from the foot point.
        let [raised, _] = lens.project([1.2, 1.0, 1.25]).unwrap();
        assert!((raised - (319.5 + 0.4 * scale)).abs() < 1e-9);
        assert_eq!(lens.project([1.0, 1.0, 3.0]), None);
    }

    #[test]
    fn a_pixel_looks_at_the_point_that_it_shows() {
        let lens = tilted();
        for (x, y, z) in [(0.0, 0.0, 0.0), (2.0, 1.5, 0.0), (0.4, 1.1, 0.3), (1.7, 0.2, 0.05)] {
            let pixel = lens.project([x, y, z]).unwrap();
            let [found_x, found_y] = lens.ray(pixel).unwrap().at(z);
            assert!((found_x - x).abs() < 1e-9 && (found_y - y).abs() < 1e-9, "{x} {y} {z}");
        }
    }

    #[test]
    fn a_camera_that_moved_is_there_and_turned_about_itself() {
        let before = Lens::above([2.0, 1.5], 2.5, [641, 481]);
        let after = before.moved([0.1, 0.2, -0.5], [0.0, 0.0, 0.5]);
        for (is, should) in after.position().into_iter().zip([1.1, 0.95, 2.0]) {
            assert!((is - should).abs() < 1e-12);
        }
        // About its own axis the point below it stays in the middle of the picture.
        let [u, v] = after.project([1.1, 0.95, 0.0]).unwrap();
        assert!((u - 320.0).abs() < 1e-9 && (v - 240.0).abs() < 1e-9);
    }
}
