//! Scenes whose picture is known exactly.
