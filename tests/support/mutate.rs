//! Broken files: those of a corpus, one a line, and what random changes make of files.
#![allow(dead_code, missing_docs, unreachable_pub)] // each test file uses its own part

use std::time::{Duration, Instant};

/// What hurts readers of text.
pub const WORDS: [&str; 34] = [
    " -1 ",
    " 0 ",
    " 1e999 ",
    " nan ",
    "\n",
    " \\\n",
    "/",
    "//",
    " 99999999999999999999 ",
    " -9223372036854775808 ",
    "18446744073709551615",
    "\r",
    "\0",
    " 4294967296 ",
    " q ",
    "f 1 2 3\n",
    "Kd 0.5\n",
    " list ",
    "element x 4000000000\n",
    "\u{feff}",
    "#",
    "\\",
    " -1.#IND ",
    "usemtl\n",
    "newmtl \u{e4}\n",
    "mtllib \".\\lamp.mtl\" #\n",
    "s 1\n",
    "f 1//0 4 3 2 7 5\n",
    "illum 0\nKs 2 nan 1 1\n",
    "map_Kd \\\n",
    "\n\r",
    " \"",
    " int64 ",
    " 1.#INF ",
];

/// SplitMix64 (Steele, Lea and Flood 2014).
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % n.max(1) as u64) as usize
    }

    /// A few random changes: bits, bytes, whole numbers at the ends of their ranges, runs that move
    /// or vanish, words that hurt.
    pub fn mutate(&mut self, good: &[u8], words: &[&str]) -> Vec<u8> {
        const NUMBERS: [u32; 8] = [0, 1, 0x7f, 0xff, 0xffff, 0x7fff_ffff, 0x8000_0000, u32::MAX];
        let mut bytes = good.to_vec();
        for _ in 0..=self.below(4) {
            let (a, b) = (self.below(bytes.len() + 1), self.below(bytes.len() + 1));
            let (a, b) = (a.min(b), a.max(b).min(a.min(b) + 40));
            match self.below(7) {
                0 if a < bytes.len() => bytes[a] ^= 1 << self.below(8),
                1 if a < bytes.len() => bytes[a] = self.below(256) as u8,
                2 => drop(bytes.drain(a..b)),
                3 => bytes.truncate(a),
                4 => {
                    let run = bytes[a..b].to_vec();
                    let at = self.below(bytes.len() + 1);
                    bytes.splice(at..at, run);
                }
                5 if a + 4 <= bytes.len() => {
                    let number = NUMBERS[self.below(NUMBERS.len())];
                    let little = self.below(2) == 0;
                    let four = if little { number.to_le_bytes() } else { number.to_be_bytes() };
                    bytes[a..a + 4].copy_from_slice(&four);
                }
                _ if words.is_empty() => {}
                _ => drop(bytes.splice(a..a, words[self.below(words.len())].bytes())),
            }
        }
        bytes
    }
}

/// The files of a corpus: a line each, in which `\n`, `\r`, `\t`, `\\` and `\u{...}` stand for what
/// they do in Rust, but for `\u{0}` to `\u{ff}` after a binary header, which nobody tells apart here.
pub fn corpus(text: &str) -> Vec<Vec<u8>> {
    text.lines().map(|line| unescaped(line).into_bytes()).collect()
}

fn unescaped(line: &str) -> String {
    let mut text = String::new();
    let mut rest = line;
    while let Some(at) = rest.find('\\') {
        text.push_str(&rest[..at]);
        rest = &rest[at + 1..];
        let (c, length) = match rest.chars().next() {
            Some('n') => ('\n', 1),
            Some('r') => ('\r', 1),
            Some('t') => ('\t', 1),
            Some('u') if rest.starts_with("u{") => {
                let end = rest.find('}').unwrap();
                let number = u32::from_str_radix(&rest[2..end], 16).unwrap();
                (char::from_u32(number).unwrap(), end + 1)
            }
            _ => ('\\', usize::from(rest.starts_with('\\'))),
        };
        text.push(c);
        rest = &rest[length..];
    }
    text + rest
}

/// What is tried: every file as it is, of which the first few are `whole`, then so many changes of them as `BURNISH_FUZZ` says, or as
/// many as come within `BURNISH_FUZZ_SECONDS`, or a few.
pub fn try_all(
    files: &[Vec<u8>],
    whole: usize,
    words: &[&str],
    seed: u64,
    mut each: impl FnMut(&[u8], &mut Random),
) -> u64 {
    let number = |name: &str| std::env::var(name).ok().map(|text| text.parse::<u64>().unwrap());
    let (count, seconds) = (number("BURNISH_FUZZ"), number("BURNISH_FUZZ_SECONDS"));
    let count = count.unwrap_or(if seconds.is_some() { u64::MAX } else { 2000 });
    let end = Instant::now() + seconds.map_or(Duration::from_secs(1 << 30), Duration::from_secs);
    // Another run of the same length tries others; the seed of one that fails is told.
    let seed = number("BURNISH_FUZZ_SEED").unwrap_or(seed);
    let mut random = Random(seed);
    files.iter().for_each(|file| each(file, &mut random));
    let mut tried = 0;
    while tried < count && Instant::now() < end {
        // Half of them of whole files: what is broken twice over says less. A few of those that are large:
        // it takes as long as a thousand others to copy one.
        let which = random.below(if tried % 2 == 0 { whole } else { files.len() });
        if files[which].len() > 1 << 20 && random.below(100) > 0 {
            continue;
        }
        let file = random.mutate(&files[which], words);
        each(&file, &mut random);
        tried += 1;
    }
    println!("{} files, {tried} changes of them, seed {seed}", files.len());
    tried
}

/// A line for each error, and not very many; nothing that steers a terminal.
pub fn is_fit(message: &str) -> bool {
    message.lines().count() <= 21
        && message.lines().all(|line| line.len() < 500 && !line.chars().any(char::is_control))
}
