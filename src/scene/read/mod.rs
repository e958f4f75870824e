//! Readers: a file becomes a [`SceneBuilder`] and a [`Report`], or an error with its line.
