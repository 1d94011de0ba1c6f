"""The data of a diagnosis: what recordings say of each cylinder and joint, and which time is for training, validation and test."""
