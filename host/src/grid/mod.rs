//! Cuts the arena into rectangular areas along the borders of the enlarged obstacles [Alghannam, Sec. III].
