// The bind groups that all strategies share, in one module: frame (0), grid (1), transfer function and
// light (2).
#import frame
#import grid
#import transfer
#import light
#import cube
