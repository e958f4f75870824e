//! Words as a shell takes them.

/// A command line for a POSIX shell.
pub(crate) fn line<T: AsRef<str>>(words: impl IntoIterator<Item = T>) -> String {
    words.into_iter().map(|word| quoted(word.as_ref())).collect::<Vec<_>>().join(" ")
}

/// A file's name as a word that no program takes for an option.
pub(crate) fn file(name: &str) -> String {
    if name.starts_with('-') { format!("./{name}") } else { name.to_owned() }
}

/// One word of it.
pub(crate) fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=:,%+".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn what_a_shell_would_take_apart_is_quoted() {
        let words = ["a", "-o", "my scene.scn", "it's", "$(x)", ""];
        let quoted = r"a -o 'my scene.scn' 'it'\''s' '$(x)' ''";
        assert_eq!(super::line(words), quoted);
        assert_eq!(["-x", "x", "./-x", ""].map(super::file), ["./-x", "x", "./-x", ""]);
    }
}
