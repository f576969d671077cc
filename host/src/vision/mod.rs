//! Finds the arena, the obstacles and the robot in an overhead picture [Alghannam, Sec. II].
