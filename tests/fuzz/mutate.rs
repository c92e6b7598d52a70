//! Mutations of bytes.

/// SplitMix64 (Steele, Lea and Flood 2014).
pub struct Numbers(u64);

impl Numbers {
    /// The numbers of input `number` of the target `name`.
    pub fn new(name: &str, number: u64) -> Self {
        let hash = name.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |h, b| {
            (h ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01b3)
        });
        Self(hash ^ number.wrapping_mul(0xd134_2543_de82_ef95))
    }

    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `n`, or 0.
    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }
}

/// Numbers at which programs break.
const EXTREMES: [&str; 22] = [
    "0",
    "-0",
    "-1",
    "1",
    "2",
    "0.5",
    "1e-45",
    "1e-300",
    "3.4e38",
    "1e39",
    "-1e39",
    "1e308",
    "1e999",
    "nan",
    "inf",
    "-inf",
    "255",
    "65536",
    "2147483648",
    "4294967296",
    "18446744073709551616",
    "00000000000000000000000000000000000000000000000000000000001",
];

/// An input: some item of the corpus, changed once or several times.
pub fn mutated(corpus: &[Vec<u8>], words: &[&str], numbers: &mut Numbers) -> Vec<u8> {
    let mut bytes = corpus[numbers.below(corpus.len())].clone();
    // Half of all inputs have one change: most of their text is still sound.
    let changes = 1 + (numbers.next().trailing_zeros() as usize).min(8);
    for _ in 0..changes {
        change(&mut bytes, corpus, words, numbers);
    }
    bytes
}

fn change(bytes: &mut Vec<u8>, corpus: &[Vec<u8>], words: &[&str], numbers: &mut Numbers) {
    let at = numbers.below(bytes.len() + 1);
    let length = numbers.below(16).max(1).min(bytes.len().saturating_sub(at));
    match numbers.below(14) {
        0 if at < bytes.len() => bytes[at] ^= 1 << numbers.below(8),
        1 if at < bytes.len() => bytes[at] = [0, 1, 127, 128, 254, 255][numbers.below(6)],
        2 => bytes.insert(at, numbers.next() as u8),
        3 => drop(bytes.drain(at..at + length)),
        4 => bytes.truncate(at),
        5 => {
            // A piece again, up to many times.
            let piece = bytes[at..at + length].to_vec();
            let times = 1 << numbers.below(8);
            bytes.splice(at..at, piece.repeat(times));
        }
        6 => {
            let other = &corpus[numbers.below(corpus.len())];
            let from = numbers.below(other.len() + 1);
            let many = numbers.below(other.len() - from + 1);
            bytes.splice(at..at + length, other[from..from + many].iter().copied());
        }
        7 | 8 if !words.is_empty() => {
            let word = words[numbers.below(words.len())];
            bytes.splice(at..at + length * (numbers.below(2)), word.bytes());
        }
        9..=11 => replace_number(bytes, at, numbers),
        12 => replace_line(bytes, at, numbers),
        // Four bytes as binary formats have them.
        _ if at + 4 <= bytes.len() => {
            let extremes = [
                0,
                1,
                0x7fff_ffff,
                0x8000_0000,
                0xffff_ffff,
                0x0001_0000,
                0x4000,
            ];
            let value: u32 = extremes[numbers.below(7)];
            let swap = numbers.below(2) == 0;
            let four = if swap {
                value.to_le_bytes()
            } else {
                value.to_be_bytes()
            };
            bytes[at..at + 4].copy_from_slice(&four);
        }
        _ => bytes.extend_from_slice(b"\n"),
    }
}

/// Replaces the first number after `at` by an extreme one.
fn replace_number(bytes: &mut Vec<u8>, at: usize, numbers: &mut Numbers) {
    let digit = |b: &u8| b.is_ascii_digit();
    let Some(start) = bytes[at..].iter().position(digit).map(|i| at + i) else {
        return;
    };
    let rest = &bytes[start..];
    let length = rest.iter().position(|b| !digit(b) && *b != b'.');
    let end = start + length.unwrap_or(rest.len());
    let extreme = EXTREMES[numbers.below(EXTREMES.len())];
    bytes.splice(start..end, extreme.bytes());
}

/// Removes the line at `at`, or says it again elsewhere.
fn replace_line(bytes: &mut Vec<u8>, at: usize, numbers: &mut Numbers) {
    let start = bytes[..at]
        .iter()
        .rposition(|b| *b == b'\n')
        .map_or(0, |i| i + 1);
    let end = bytes[at..]
        .iter()
        .position(|b| *b == b'\n')
        .map_or(bytes.len(), |i| at + i + 1);
    let line: Vec<u8> = if numbers.below(2) == 0 {
        bytes.drain(start..end).collect()
    } else {
        bytes[start..end].to_vec()
    };
    let to = numbers.below(bytes.len() + 1);
    if numbers.below(2) == 0 {
        bytes.splice(to..to, line);
    }
}
