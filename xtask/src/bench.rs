pub fn slicing() -> Result<(), String> { Err("x".into()) }
pub fn quality() -> Result<(), String> { Err("x".into()) }
