//! Finds the way from start to goal through the areas [Alghannam, Sec. III].
